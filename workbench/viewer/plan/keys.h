// The window's mouse and key bindings, as --help and the window's own help print them.
#pragma once

#include <array>
#include <string_view>

namespace forcelayer::viewer {

inline constexpr std::array<std::string_view, 9> kKeyLines = {
    "mouse: left turns the view (z stays up), middle or shift-left moves it, right or wheel zooms",
    "1-8: show or hide meshes, interior, force layer, proximity, part, shell, contacts, hand",
    "f: whole scene   p: follow the part, or stop   x y z: look along an axis (shift: the "
    "opposite way)",
    "c: cut across x, y, z, none   shift-c: other side   comma, period: move the cut by a voxel "
    "(shift: ten)",
    "m: first point of a measurement   m again: second point   shift-m: stop",
    "o: show or hide the tree of objects   up down: choose   return: open or close   v: hide or "
    "show   i: show only this object, or all   a: show all   (without the tree, v and i apply "
    "to the object under the pointer)",
    "space: play or pause   - +: slower, faster   (or the buttons in the strip)   click or drag in "
    "the strip: go there",
    "left right: one frame back or forward (shift: ten)   home end: first, last   n: next "
    "contact   shift-n: previous",
    "g: next motion that the guard shortened   shift-g: previous   h: these keys   "
    "q: end"};

}  // namespace forcelayer::viewer
