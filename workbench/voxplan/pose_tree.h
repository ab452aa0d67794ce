// PoseIndex as OMPL's planners know it: what they hold has a `state`, a PoseState.
#pragma once

#include <ompl/datastructures/NearestNeighborsLinear.h>

#include <vector>

#include "workbench/voxplan/nearest/pose_index.h"
#include "workbench/voxplan/pose_space.h"

namespace forcelayer::voxplan {

// Its distance function is that of PoseSpace, with the same `turn_m`.
template <class Held>
class PoseTree final : public ompl::NearestNeighborsLinear<Held> {
  using Linear = ompl::NearestNeighborsLinear<Held>;

 public:
  explicit PoseTree(double turn_m) : index_(turn_m) {}

  void clear() override {
    Linear::clear();
    index_.clear();
  }
  void add(const Held& held) override {
    Linear::add(held);
    index_.add(pose_of(held->state));
  }
  void add(const std::vector<Held>& all) override {
    for (const Held& held : all) add(held);
  }
  bool remove(const Held& held) override {
    if (!Linear::remove(held)) return false;
    index_.clear();
    for (const Held& left : this->data_) index_.add(pose_of(left->state));
    return true;
  }
  Held nearest(const Held& held) const override {
    if (this->data_.empty()) return Linear::nearest(held);  // which throws
    return this->data_[index_.nearest(pose_of(held->state))];
  }

 private:
  PoseIndex index_;
};

}  // namespace forcelayer::voxplan
