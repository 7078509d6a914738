// What was done to the data of each stance, in sentences: one for all stances of which the same is said, so
// that a recording of twenty steps is as readable as one of two.
#pragma once

#include <string>
#include <vector>

#include "problems/contact/motion/marker_pose.h"
#include "problems/contact/stance.h"

namespace sinew {

class StanceNotes {
 public:
  /// Coordinates without data, at the model's default. None: nothing is said.
  void Held(const std::string& trial, const std::vector<std::string>& coordinates);
  /// The foot was moved to its markers. Without markers nothing is said.
  void MovedToMarkers(const Stance& stance, const MarkerPose& pose);
  /// @param height by which the recorded motion was raised [m]; less than half a millimetre is not said
  void Raised(const Stance& stance, double height);
  /// Of a channel's recorded samples, those that are not compared. None: nothing is said.
  void NotCompared(const Stance& stance, const std::string& channel, std::size_t missing,
                   std::size_t recorded);
  /// Why the load of the whole body cannot be used.
  void NoBodyLoad(const Stance& stance, const std::string& why);

  [[nodiscard]] std::vector<std::string> Sentences() const;

 private:
  struct Where {
    std::string trial;
    std::string plate;
    [[nodiscard]] std::string Words() const;
  };
  struct Pose {
    Where where;
    std::size_t markers;
    MarkerPose pose;
  };
  struct Height {
    Where where;
    double raised;  // [m]
  };
  struct Missing {
    std::string trial;
    std::string channel;
    std::size_t missing;
    std::size_t recorded;
  };
  // What is said, and of which trials or stances.
  struct Said {
    std::string what;
    std::vector<std::string> of;
  };
  static void Say(std::vector<Said>& list, const std::string& what, std::string of);

  void AddPoses(std::vector<std::string>& sentences) const;
  void AddHeights(std::vector<std::string>& sentences) const;
  void AddMissing(std::vector<std::string>& sentences) const;

  std::vector<Said> held_;
  std::vector<Said> no_load_;
  std::vector<Pose> poses_;
  std::vector<Height> heights_;
  std::vector<Missing> missing_;
};

}  // namespace sinew
