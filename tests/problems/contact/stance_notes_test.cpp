#include "problems/contact/stance_notes.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Stance StanceWithMarkers(int number, int markers) {
  Stance stance;
  stance.trial = fmt::format("step_{}", number);
  stance.plate = "left";
  stance.markers.markers.resize(static_cast<std::size_t>(markers));
  return stance;
}

StanceNotes NotesOf(int stances) {
  StanceNotes notes;
  for (int s = 1; s <= stances; ++s) {
    const Stance stance = StanceWithMarkers(s, 4);
    MarkerPose pose;
    pose.residual_recorded = 1e-3 * s;
    pose.residual = 5e-4;
    pose.shift = 2e-3 * s;
    pose.turn = 0.0174533 * s;
    pose.noise.marker = 2e-5;
    notes.Held(stance.trial, {"head_yaw"});
    notes.MovedToMarkers(stance, pose);
    notes.NoBodyLoad(stance, "the body does not move over the foot");
    notes.Raised(stance, s == 2 ? -9e-3 : 1e-3 * s);
    notes.NotCompared(stance, "left_force_y", static_cast<std::size_t>(s), 50);
  }
  return notes;
}

TEST(StanceNotes, FewStancesHaveASentenceEach) {
  EXPECT_THAT(
      NotesOf(2).Sentences(),
      ElementsAre(
          "trial 'step_1'; trial 'step_2': no data for head_yaw: held at the model's default",
          "trial 'step_1', left: the 4 markers on the foot lie 1.0 mm from the recorded motion, 0.5 mm "
          "from the foot's own, which differs from it by 2.0 mm and 1.0 degrees (root mean squares); their "
          "noise "
          "from frame to frame is 0.02 mm",
          "trial 'step_2', left: the 4 markers on the foot lie 2.0 mm from the recorded motion, 0.5 mm "
          "from the foot's own, which differs from it by 4.0 mm and 2.0 degrees (root mean squares); their "
          "noise "
          "from frame to frame is 0.02 mm",
          "trial 'step_1', left; trial 'step_2', left: the whole body's load is not used: the body does "
          "not move over the foot",
          "trial 'step_1', left: the recorded motion was raised by 1.0 mm, so that the flat foot is as "
          "high as in the fitted stances",
          "trial 'step_2', left: the recorded motion was lowered by 9.0 mm, so that the flat foot is as "
          "high as in the fitted stances",
          "trial 'step_1': 1 of 50 samples of 'left_force_y' are not compared (gaps, no motion there, or "
          "a light foot)",
          "trial 'step_2': 2 of 50 samples of 'left_force_y' are not compared (gaps, no motion there, or "
          "a light foot)"));
}

TEST(StanceNotes, ManyStancesShareOne) {
  EXPECT_THAT(
      NotesOf(20).Sentences(),
      ElementsAre(
          "trial 'step_1'; trial 'step_2'; trial 'step_3' and 17 more: no data for head_yaw: held at the "
          "model's default",
          "in 20 stances the markers on the foot lie 1.0 to 20.0 mm from the recorded motion (most in "
          "trial 'step_20', left), 0.5 to 0.5 mm from the foot's own, which differs from it by 2.0 to "
          "40.0 mm and 1.0 to 20.0 degrees (root mean squares); their noise from frame to frame is 0.02 mm "
          "at most",
          "trial 'step_1', left; trial 'step_2', left; trial 'step_3', left and 17 more: the whole body's "
          "load is not used: the body does not move over the foot",
          "the recorded motion of 20 stances was raised or lowered, by 1.0 to 20.0 mm (most in trial "
          "'step_20', left: raised), so that flat feet are as high as in the fitted stances",
          "of 'left_force_y', 210 of 1000 samples in 20 trials are not compared (gaps, no motion there, or "
          "a light foot)"));
}

TEST(StanceNotes, NothingIsSaidWhereNothingWasDone) {
  StanceNotes notes;
  const Stance bare = StanceWithMarkers(1, 0);
  notes.Held(bare.trial, {});
  notes.MovedToMarkers(bare, {});
  notes.Raised(bare, 4e-4);
  notes.NotCompared(bare, "left_force_y", 0, 50);
  EXPECT_THAT(notes.Sentences(), IsEmpty());
}

}  // namespace
}  // namespace sinew
