// The window's mouse and key bindings, as --help and the window's own help print them.
#pragma once

#include <array>
#include <string_view>

namespace forcelayer::viewer {

inline constexpr std::array<std::string_view, 9> kKeyLines = {
    "mouse: left turns (z stays upright), middle or shift-left moves, right or wheel zooms",
    "1-8: meshes, interior, force layer, proximity, part, shell, contacts, hand on and off",
    "f: whole scene   p: go with the part, or stop   x y z: along an axis, with shift against it",
    "c: cut across x, y, z, none   shift-c: other side   , . move it by a voxel, with shift by ten",
    "m: measure from what is under the pointer, m again: to what is under it then   shift-m: no "
    "more",
    "o: tree of objects, on and off   up down: choose   return: open or close   v: hide or show   "
    "i: alone, or all   a: all   (without the tree: what is under the pointer)",
    "space: play or pause   - +: slower, faster   or by the buttons in the strip   click or drag "
    "in it: go there",
    "left right: a frame, with shift ten   home end: first, last   n: next contact",
    "g: next guard cut   shift-n shift-g: the one before   h: keys   q: end"};

}  // namespace forcelayer::viewer
