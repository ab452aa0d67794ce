// The objects of a picture as a tree by their names, and which of them are shown.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace forcelayer::viewer {

class ObjectTree {
 public:
  enum class Shown { kNone, kSome, kAll };

  // A line of the tree: an object, or a group of objects whose names begin alike.
  struct Row {
    std::size_t node;  // for select()
    std::string_view label;
    std::size_t depth;
    bool is_group, is_open;
    Shown shown;
    std::size_t objects;  // in it, ...
    std::size_t object;   // ... and the first of them
  };

  // `names`: paths, "/" between their parts. All are shown, every group is open.
  explicit ObjectTree(const std::vector<std::string>& names);

  bool empty() const { return shown_.empty(); }
  bool is_shown(std::size_t object) const { return shown_[object] != 0; }
  std::vector<std::string> hidden() const;  // names

  std::vector<Row> rows() const;  // without those in closed groups
  std::size_t selected() const { return selected_; }

  void select(std::size_t node);
  void select_object(std::string_view name);  // nothing where there is none
  void step(int rows);                        // selects a row further down (> 0) or up
  void fold();                                // opens or closes the group that is selected
  void toggle();                              // hides the selected objects, or shows them
  void isolate();                             // shows these alone; all, where that is so already
  void show_all();
  void hide(const std::vector<std::string>& names);  // these, and no others

 private:
  struct Node {
    std::string label;
    std::size_t parent;
    std::size_t depth;
    std::vector<std::size_t> children;
    std::vector<std::size_t> objects;  // of the node and of all below it, ascending
    bool is_open = true;
  };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  std::size_t child_of(std::size_t parent, std::string_view label);
  Shown shown_of(const Node& node) const;
  void add_rows(const std::vector<std::size_t>& nodes, std::vector<Row>& rows) const;

  std::vector<std::string> names_;   // [objects]
  std::vector<char> shown_;          // [objects]
  std::vector<std::size_t> leaves_;  // [objects] its node
  std::vector<Node> nodes_;
  std::vector<std::size_t> roots_;
  std::size_t selected_ = 0;
};

}  // namespace forcelayer::viewer
