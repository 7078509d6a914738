// Excitations of a whole trial that are adjusted or found, frame by frame: the modes of nms beyond open loop.
// SCIENCE section 3; Sartori, Farina, Lloyd 2014; Pizzolato et al. 2015 (see excitation_frame.h).
//
// One frame is one sample of the lengths. What a free muscle's excitation of the frame changes is its
// activation then; the past of its filter, and the length of its fibre before if the tendon is elastic, are
// those that the excitations found so far have made (as CEINMS does it). So nothing is known of later frames,
// and a slow filter or a slack tendon makes excitations hard (FoundExcitations::slack).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "problems/nms/excitation/mode.h"
#include "problems/nms/problem.h"

namespace sinew {

/// Of one trial. An excitation acts at a frame: it was sent the muscle's electromechanical delay earlier.
struct FoundExcitations {
  std::string trial;
  std::vector<double> time;        ///< [N, s] of the frames
  std::vector<Vector> excitation;  ///< [muscles] [N, 0..1], of those that are not free as measured
  std::vector<Vector> measured;    ///< [muscles] [N, 0..1]; empty where it is not measured
  Vector objective;                ///< [N] with the effort of all muscles, as CEINMS has it
  Vector gap;                      ///< [N] no excitations are lower by more (FrameSolution)
  int followed = 0;                ///< frames with a measured moment
  int unsettled = 0;               ///< frames whose search did not converge
  /// [muscles] frames in which no excitation moves the muscle's force: its elastic tendon hangs slack, and
  /// the fibre does not take that up within one frame. The search cannot foresee the force that it would have
  /// later.
  std::vector<int> slack;
  double seconds = 0;  ///< that it took
};

/// Is shown every frame after it was solved and before its excitations are passed on.
using FrameWatcher = std::function<void(std::size_t trial, std::size_t frame, const ExcitationFrame& problem,
                                        const FrameMuscles& muscles, const FrameSolution& solution)>;

/// Finds the excitations of every trial and puts them into the problem, whose predictions are then those of
/// the mode.
/// @param problem made with free.synthesised as unmeasured
/// Errors: a tendon in equilibrium, whose fibre velocity depends on later frames; effects on excitations, and
/// of a compliant tendon, that are not at rest; a joint that is followed but nowhere measured; no equilibrium
/// of fibre and tendon, with trial, muscle and time.
Result<std::vector<FoundExcitations>> FindExcitations(NmsProblem& problem, const Vector& parameters,
                                                      const NmsMode& mode, const FreeMuscles& free,
                                                      const FrameWatcher& watch = {});

}  // namespace sinew
