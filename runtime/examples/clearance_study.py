"""How near did the part come, where, and what if the hand had gone elsewhere?

A notebook as a script: each `# %%` begins a cell in editors that know them. Needs numpy and
matplotlib, and in the working folder bay.vox, part.pshell and run.flr:

    voxelize sample_data/bay.json --voxel-size 5mm -o bay.vox
    pointshell sample_data/part.obj --units mm --voxel-size 5mm -o part.pshell
    voxrun bay.vox part.pshell --motion sample_data/press.csv --as-fast-as-possible --record run.flr
"""

# %% The recorded run, again
import numpy
from matplotlib import pyplot

import forcelayer

scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
run = forcelayer.replay(scene, part, "run.flr")
least = run.report["min_clearance"]
print(f"least clearance {1000 * least['clearance_m']:.2f} mm to {least['object']} at {least['t_s']} s")

# %% Its clearance over time, colored by the object that is nearest
answers = scene.clearance(part, run.frames["world_from_part"])
for number in numpy.unique(answers["nearest_object"][answers["measured"]]):
    mine = answers["measured"] & (answers["nearest_object"] == number)
    pyplot.plot(run.frames["t_s"][mine], 1000 * answers["clearance_m"][mine], ".", ms=2,
                label=scene.objects[number].rsplit("/")[-1])
pyplot.xlabel("time (s)"), pyplot.ylabel("proven clearance (mm)"), pyplot.legend(fontsize=7)
pyplot.savefig("clearance.png", dpi=120), pyplot.close()

# %% The scene around the narrowest place: distances in an upright plane
x, y, z = least["point_m"]
across = numpy.linspace(-0.06, 0.06, 241)
plane = numpy.stack(numpy.meshgrid([x], y + across, z + across, indexing="ij"), axis=-1)
distance = scene.sample(plane.reshape(-1, 3))["distance_m"].reshape(len(across), -1)
pyplot.imshow(1000 * distance.T, extent=[-60, 60, -60, 60], origin="lower", cmap="viridis")
pyplot.colorbar(label="distance from the meshes (mm)"), pyplot.plot(0, 0, "r+")
pyplot.xlabel("y (mm)"), pyplot.ylabel("z (mm)")
pyplot.savefig("plane.png", dpi=120), pyplot.close()

# %% The same way, moved by up to 10 mm to each side: which is the best?
poses = run.frames["world_from_part"]
shifts = numpy.linspace(-0.01, 0.01, 9)
moved = numpy.repeat(poses[numpy.newaxis, ::10], len(shifts), axis=0)
moved[:, :, 1] += shifts[:, numpy.newaxis]
clearance = scene.clearance(part, moved.reshape(-1, 7))["clearance_m"].reshape(len(shifts), -1)
worst = numpy.where(numpy.isnan(clearance), 0, clearance).min(axis=1)
best = worst.argmax()
print(f"moved by {1000 * shifts[best]:.1f} mm along y it would keep {1000 * worst[best]:.2f} mm")

# %% A hand that is not in the recording: from where the part is after 1.2 s, on towards the beam
simulation = forcelayer.Simulation(scene, part)
simulation.start(poses[1200])
hand = numpy.repeat(poses[1200:1201], 2000, axis=0)
hand[:, 1] += numpy.linspace(0, 0.25, len(hand))
frames = simulation.run(hand)
force = numpy.linalg.norm(frames["force_n"], axis=1)
print(f"pushed 250 mm on: up to {force.max():.1f} N; "
      f"{simulation.report['penetration_frames']} penetration frames")
