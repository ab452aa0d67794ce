// The output of a device's I/O side while the loop is late.
#include "runtime/devices/output_watch.h"

#include <gtest/gtest.h>

namespace forcelayer::test {
namespace {

const Wrench kPush{{3, 0, 0}, {0, 0.1, 0}};

TEST(OutputWatch, GivesNothingBeforeTheLoopsFirstZero) {
  devices::OutputWatch watch;
  EXPECT_EQ(watch.pass(kPush, 0).force_n.x, 0);
  EXPECT_EQ(watch.pass({}, 0).force_n.x, 0);
  EXPECT_EQ(watch.pass(kPush, 0).force_n.x, 3);
}

TEST(OutputWatch, HoldsFadesAndLatches) {
  devices::OutputWatch watch;
  watch.pass({}, 0);
  EXPECT_EQ(watch.pass(kPush, 0.0015).force_n.x, 3);
  EXPECT_NEAR(watch.pass(kPush, 0.0035).force_n.x, 1.5, 1e-12);
  EXPECT_NEAR(watch.pass(kPush, 0.0035).torque_nm.y, 0.05, 1e-12);
  EXPECT_EQ(watch.pass(kPush, 0.0001).force_n.x, 3);  // a late frame was a blip
  EXPECT_EQ(watch.pass(kPush, 0.0051).force_n.x, 0);
  EXPECT_TRUE(watch.latched());
  EXPECT_EQ(watch.pass(kPush, 0).force_n.x, 0);  // the loop is back, but has not begun anew
  EXPECT_EQ(watch.pass({}, 0.006).force_n.x, 0);
  EXPECT_EQ(watch.pass(kPush, 0).force_n.x, 0);  // an old zero tells nothing of the loop now
  watch.pass({}, 0);
  EXPECT_EQ(watch.pass(kPush, 0).force_n.x, 3);
}

// It has a limit of its own, whatever the loop asks for.
TEST(OutputWatch, NoOneAsksForMoreThanItsCeiling) {
  for (const double stale_s : {10.0, 1e300, 0 / 0.0}) {
    devices::OutputWatch watch(stale_s);
    watch.pass({}, 0);
    EXPECT_EQ(watch.pass(kPush, 0.02).force_n.x, 3);
    EXPECT_EQ(watch.pass(kPush, 0.0501).force_n.x, 0);
    EXPECT_TRUE(watch.latched());
  }
}

TEST(OutputWatch, AnAgeThatIsNoNumberIsTooOld) {
  devices::OutputWatch watch;
  watch.pass({}, 0);
  EXPECT_EQ(watch.pass(kPush, 0 / 0.0).force_n.x, 0);
  EXPECT_TRUE(watch.latched());
  watch.pass({}, 0);
  EXPECT_EQ(watch.pass(kPush, -1e9).force_n.x, 0);  // written in a time to come
  EXPECT_TRUE(watch.latched());
}

}  // namespace
}  // namespace forcelayer::test
