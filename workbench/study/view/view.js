// The 3D view of a study's page: the motion as voxcheck wrote it, beside the clearance curve.
(function () {
  'use strict';
  const get = (id) => document.getElementById(id);
  const data = JSON.parse(get('view-data').textContent);
  const curve = data.curve;  // pieces [from_m, to_m, from_s, to_s, clearance_m]
  const length_m = Math.max(curve[curve.length - 1][1], 1e-9);  // of a part that rests, too
  const kPart = 0xe69f00, kNear = 0x0072b2, kOther = 0xb8bcc2, kMark = 0xc00000;  // as voxview draws
  const kPlay_s = 6;                 // for the whole path
  const kEdgeTriangles = 200000;     // more edges are slow to find

  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({canvas: get('canvas'), antialias: true, alpha: true});
  } catch (error) {
    return;  // the page says why there is no view
  }
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(35, 1, 0.001, 1000);
  const light = new THREE.DirectionalLight(0xffffff, 0.5);
  scene.add(new THREE.HemisphereLight(0xffffff, 0xa0a8b4, 0.7), camera);
  camera.add(light);
  light.position.set(-0.4, 0.7, 1);
  const controls = new THREE.OrbitControls(camera, get('canvas'));
  controls.screenSpacePanning = true;
  controls.addEventListener('change', draw);

  const bytes = Uint8Array.from(atob(get('view-motion').textContent.trim()), (c) => c.charCodeAt(0));
  new THREE.GLTFLoader().parse(bytes.buffer, '', (gltf) => {
    const nodes = gltf.parser.json.nodes.map((node, n) => gltf.parser.getDependency('node', n));
    Promise.all(nodes).then((found) => start(gltf, found));
  });

  let move, mark, along_m = 0, part, world, playing = 0;
  let map = null;       // what the colors of a clearance map mean: asset.extras of the file
  let section = null;  // {axis: 'x', at_m}: in the axes of the assembly
  const all = [];

  function start(gltf, nodes) {
    scene.add(gltf.scene);
    map = (gltf.asset.extras || {}).clearance_map;
    world = nodes[0];
    part = nodes[1];
    const triangles = nodes.reduce((sum, node) => sum + (node.isMesh ? node.geometry.index.count / 3 : 0), 0);
    nodes.slice(1).forEach((node, n) => {
      const name = gltf.parser.json.nodes[n + 1].name;
      const color = n === 0 ? kPart : data.near.includes(name) ? kNear : kOther;
      node.material = new THREE.MeshPhongMaterial({
        color, side: THREE.DoubleSide, flatShading: true, shininess: 10,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
      // Seen in a section: what is behind a closed surface has one color, as if it were filled.
      const inside = new THREE.Mesh(node.geometry, new THREE.MeshBasicMaterial({
        color: new THREE.Color(color).multiplyScalar(0.6), side: THREE.BackSide}));
      inside.visible = false;
      node.add(inside);
      if (triangles < kEdgeTriangles) {
        const edges = new THREE.EdgesGeometry(node.geometry, 25);
        node.add(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({color: 0x333333})));
      }
      all.push({node, name, color, is_plain: color === kOther, is_mapped: map && color_vertices(node.geometry),
                box: list(node, name, color)});
    });
    const mixer = new THREE.AnimationMixer(part);
    const action = mixer.clipAction(gltf.animations[0]);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
    move = (time_s) => {
      action.time = Math.min(time_s, action.getClip().duration);
      mixer.update(0);
    };
    mark = new THREE.Mesh(new THREE.SphereBufferGeometry(1, 16, 12),
                          new THREE.MeshBasicMaterial({color: kMark, depthTest: false, transparent: true}));
    mark.renderOrder = 9;
    mark.visible = false;
    world.add(mark);
    get('no-view').remove();
    get('view').hidden = false;
    see_through();
    wire();
    resize();
    fit();
    follow_link();
  }

  // Gives each vertex the color of its clearance. Whether one is on the scale.
  function color_vertices(geometry) {
    const clearance = geometry.attributes._clearance_m, rgb = [];
    const colors = map.colors.map((step) => new THREE.Color(step.srgb)), beyond = new THREE.Color(map.beyond);
    let is_mapped = false;
    for (let n = 0; n < geometry.attributes.position.count; ++n) {
      const at = clearance ? clearance.getX(n) / map.reach_m * (colors.length - 1) : Infinity;
      const step = Math.floor(at + 1e-5);  // of 32-bit floats
      const is_on = step < colors.length - 1;
      is_mapped = is_mapped || is_on;
      (is_on ? colors[step].clone().lerp(colors[step + 1], Math.max(0, at - step)) : beyond).toArray(rgb, 3 * n);
    }
    geometry.setAttribute('color', new THREE.Float32BufferAttribute(rgb, 3));
    return is_mapped;
  }

  // Colors by the clearance map, or by object.
  function color_all() {
    const by_map = get('map').checked;
    get('legend').hidden = !by_map;
    for (const {node, color, is_mapped} of all) {
      node.material.color.set(by_map ? 0xffffff : color);
      node.material.vertexColors = by_map ? THREE.VertexColors : THREE.NoColors;
      node.material.needsUpdate = true;
      node.userData.stands_out = by_map && is_mapped;
    }
    see_through();
  }

  function list(node, name, color) {
    const label = document.createElement('label'), box = document.createElement('input');
    const swatch = document.createElement('i');
    box.type = 'checkbox';
    box.checked = true;
    box.onchange = () => show((object) => object.node === node, box.checked);
    swatch.style.background = '#' + color.toString(16).padStart(6, '0');
    label.append(box, swatch, document.createElement('span'));
    label.lastChild.textContent = label.title = name;
    get('objects').append(label);
    return box;
  }

  function show(named, visible) {
    for (const {node, box} of all.filter(named)) {
      node.visible = box.checked = visible;
      box.parentNode.className = visible ? '' : 'hidden';
    }
    draw();
  }

  // Objects hide neither the part nor its neighbors: those that the report names are less clear.
  function see_through() {
    for (const {node, is_plain} of all) {
      const clear = node !== part && !get('solid').checked && !section && !node.userData.stands_out;
      Object.assign(node.material, {transparent: clear, opacity: !clear ? 1 : is_plain ? 0.2 : 0.35, depthWrite: !clear,
                                    side: section ? THREE.FrontSide : THREE.DoubleSide});
      const [inside, lines] = node.children;
      inside.visible = Boolean(section);
      if (lines) lines.material.color.set(clear && is_plain ? 0x999999 : 0x333333);
    }
    draw();
  }

  // All objects as they are now, in the axes of the assembly.
  function bounds() {
    const box = new THREE.Box3();
    for (const {node} of all) box.union(new THREE.Box3().setFromObject(node));
    return new THREE.Box3().setFromPoints([box.min, box.max].map((corner) => world.worldToLocal(corner)));
  }

  // Cuts all objects across an axis, at a position or else through the marked point, or the part's middle.
  function cut(axis, at_m) {
    if (axis && at_m === undefined) {
      const middle = new THREE.Box3().setFromObject(part).getCenter(new THREE.Vector3());
      at_m = (mark.visible ? mark.position : world.worldToLocal(middle))[axis];
    }
    section = axis ? {axis, at_m} : null;
    get('section').value = axis;
    get('cut').disabled = !section;
    if (section) {
      const {min, max} = bounds();
      get('cut').value = (at_m - min[axis]) / (max[axis] - min[axis]);
    }
    get('cut-at').textContent = section ? axis + ' = ' + (1e3 * at_m).toFixed(2) + ' mm' : '';
    see_through();
  }

  // The half beyond the section, as the camera sees it, stays.
  function section_planes() {
    if (!section) return [];
    const {axis, at_m} = section, normal = new THREE.Vector3();
    const side = world.worldToLocal(camera.position.clone())[axis] > at_m ? -1 : 1;
    normal[axis] = side;
    return [new THREE.Plane(normal, -side * at_m).applyMatrix4(world.matrixWorld)];
  }

  function wire() {
    get('along').oninput = () => go(get('along').value * length_m);
    get('fit').onclick = fit;
    get('solid').onchange = see_through;
    if (map) {
      const [bar, words] = get('legend').children, steps = map.colors.map((step) => step.srgb);
      bar.style.background = 'linear-gradient(to right, ' + steps.join() + ')';
      const below_m = map.within_m + map.deviations_and_rounding_m;
      words.textContent = mm(map.reach_m) + '. Gray: more, or ignored.' +
        (below_m < 1e-6 ? '' : ' Each value may be up to ' + mm(below_m) + ' below the true one, never above.');
      get('map-choice').hidden = false;
      get('map').onchange = color_all;
    }
    get('section').onchange = () => cut(get('section').value);
    get('cut').oninput = () => {
      const {axis} = section, {min, max} = bounds();
      cut(axis, min[axis] + get('cut').value * (max[axis] - min[axis]));
    };
    get('all').onchange = () => show(() => true, get('all').checked);
    get('filter').oninput = () => {
      const text = get('filter').value.toLowerCase();
      for (const {name, box} of all) box.parentNode.hidden = !name.toLowerCase().includes(text);
    };
    get('play').onclick = () => {
      playing = playing ? 0 : performance.now() - (along_m < length_m ? along_m / length_m : 0) * 1000 * kPlay_s;
      get('play').textContent = playing ? 'Pause' : 'Play';
      if (playing) requestAnimationFrame(step);
    };
    for (const moment of data.moments) {
      const button = document.createElement('button');
      button.textContent = moment.name;
      button.onclick = () => go(moment.along_m, moment);
      get('moments').append(button);
    }
    const svg = document.querySelector('svg[data-length-m]');
    if (svg) {  // the curve is a slider, too
      svg.style.cursor = 'pointer';
      svg.onclick = (event) => {
        const box = svg.getBoundingClientRect(), place = svg.dataset;
        const x = (event.clientX - box.left) / box.width * svg.viewBox.baseVal.width;
        go((x - place.left) / (place.right - place.left) * length_m);
      };
    }
    addEventListener('resize', resize);
    addEventListener('hashchange', follow_link);
  }

  function step(now) {
    if (!playing) return;
    const fraction = (now - playing) / 1000 / kPlay_s;
    if (fraction >= 1) get('play').onclick();
    go(Math.min(fraction, 1) * length_m);
    requestAnimationFrame(step);
  }

  // Pieces at a position: two where one ends and the next begins.
  function pieces_at(m) {
    const slack_m = 1e-9 * length_m, end_m = curve[curve.length - 1][1];  // 0 of a part that rests
    const at_m = Math.min(m, end_m);
    return curve.filter((piece) => piece[0] <= at_m + slack_m && at_m - slack_m <= piece[1]);
  }

  // Rounded down to three decimals, or to three digits of a small length, as on the terminal.
  const mm = (m) => {
    const decimals = m > 0 ? Math.min(15, Math.max(3, Math.ceil(-Math.log10(1e3 * m) - 1e-9) + 2)) : 3;
    const scale = 10 ** decimals;
    return (Math.floor(1e3 * m * scale + 1e-6) / scale).toFixed(decimals).replace(/\.?0+$/, '') + ' mm';
  };

  // Moves the part to a position along the path; at a moment of the report its words are shown.
  function go(m, moment) {
    along_m = Math.max(0, Math.min(m, length_m));
    const pieces = pieces_at(along_m), piece = pieces[0];
    const fraction = piece[1] > piece[0] ? (along_m - piece[0]) / (piece[1] - piece[0]) : 0;
    const time_s = moment ? moment.t_s : piece[2] + fraction * (piece[3] - piece[2]);
    move(time_s - curve[0][2]);
    const proven_m = Math.min(...pieces.map((each) => each[4]));
    get('along').value = along_m / length_m;
    get('now').textContent = 'after ' + (1e3 * along_m).toFixed(1) + ' of ' + (1e3 * length_m).toFixed(1) + ' mm: ' +
                             (moment ? moment.words : 'at least ' + mm(proven_m) + ' (proven)');
    mark.visible = Boolean(moment && moment.point_m);
    if (mark.visible) mark.position.fromArray(moment.point_m);
    point_out(moment ? moment.value_m : proven_m);
    if (mark.visible && section) cut(section.axis);
    draw();
  }

  // The mark on the curve.
  function point_out(value_m) {
    const svg = document.querySelector('svg[data-length-m]');
    if (!svg) return;
    const place = svg.dataset;
    let here = get('here');
    if (!here) {
      here = document.createElementNS('http://www.w3.org/2000/svg', 'g');
      here.id = 'here';
      here.innerHTML = '<path stroke="#c00000" stroke-width="1.5"/><circle r="4.5" fill="#c00000"/>';
      svg.append(here);
    }
    const x = +place.left + along_m / length_m * (place.right - place.left);
    const y = place.bottom - Math.min(1, value_m / place.topM) * (place.bottom - place.top);
    here.children[0].setAttribute('d', `M${x} ${place.top}V${place.bottom}`);
    here.children[1].setAttribute('cx', x);
    here.children[1].setAttribute('cy', y);
  }

  // Shows all of the motion, and as much of the scene as fits beside it.
  function fit() {
    const motion = new THREE.Box3(), back_m = along_m, kSteps = 24, kAround = 3;
    for (let n = 0; n <= kSteps; ++n) {
      const piece = pieces_at(n / kSteps * length_m)[0];
      move((n === kSteps ? curve[curve.length - 1][3] : piece[2]) - curve[0][2]);
      part.updateMatrixWorld(true);
      motion.union(new THREE.Box3().setFromObject(part));
    }
    const size = motion.getSize(new THREE.Vector3()).length(), whole = motion.clone();
    for (const {node} of all) if (node !== part) whole.union(new THREE.Box3().setFromObject(node));
    const every = whole.getSize(new THREE.Vector3()).length();
    const box = every < kAround * size ? whole : motion.expandByScalar(0.25 * size);
    const center = box.getCenter(new THREE.Vector3());
    // In the camera's axes: the middle of the box's corners, and how far away all of them fit.
    const back = new THREE.Vector3(0.45, 0.5, 1).normalize();
    const right = new THREE.Vector3(0, 1, 0).cross(back).normalize(), up = back.clone().cross(right);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) => {
      const corner = new THREE.Vector3(n & 1 ? box.max.x : box.min.x, n & 2 ? box.max.y : box.min.y,
                                       n & 4 ? box.max.z : box.min.z).sub(center);
      return [corner.dot(right), corner.dot(up), corner.dot(back)];
    });
    const tangent = Math.tan(camera.fov / 2 * Math.PI / 180), kMargin = 1.08;
    const fits = ([x, y, z]) => z + kMargin * Math.max(Math.abs(y), Math.abs(x) / camera.aspect) / tangent;
    const away_m = Math.max(...corners.map(fits));
    camera.near = away_m / 200;
    camera.far = away_m + 10 * every;
    camera.position.copy(center).addScaledVector(back, away_m);
    camera.updateProjectionMatrix();
    controls.target.copy(center);
    controls.update();
    mark.scale.setScalar(0.006 * box.getSize(new THREE.Vector3()).length());
    go(back_m);
  }

  function resize() {
    const stage = get('canvas').parentNode, width = Math.max(50, stage.clientWidth - get('objects').parentNode.offsetWidth);
    const height = stage.clientHeight;
    get('canvas').style.maxWidth = width + 'px';
    renderer.setPixelRatio(window.devicePixelRatio);
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    draw();
  }

  function draw() {
    renderer.clippingPlanes = section_planes();
    renderer.render(scene, camera);
  }

  // report.html#worst, report.html#at=12.5 (mm), &section=x:12.5 (mm), or &section=x through the marked point,
  // &hide=NAME for each object to hide, and &map for the colors of the clearance map.
  function follow_link() {
    let at = 0, moment, axis = '', cut_m;  // of the section
    for (const word of location.hash.slice(1).split('&')) {
      const [key, value] = word.split('=').map(decodeURIComponent);
      if (key === 'at') at = value / 1e3;
      if (key === 'worst') [moment] = data.moments;
      if (key === 'section') [axis, cut_m] = section_of(value);
      if (key === 'hide') show(({name}) => name === value, false);
      if (key === 'map' && map) get('map').checked = true, color_all();
    }
    go(moment ? moment.along_m : at, moment);
    cut(axis, cut_m);
  }

  // "x:12.5" (mm) or "x"; no section for other words.
  function section_of(words) {
    const [, axis, mm] = /^([xyz])(?::(-?[0-9.]+))?$/.exec(words) || [null, ''];
    return [axis, mm === undefined ? mm : mm / 1e3];
  }
})();
