// The reference path: Simbody's own ElasticFoundationForce on a prescribed state. Slow; the fast path is
// tested against it, and forward simulations use it.
#pragma once

#include <memory>
#include <vector>

#include "base/error.h"
#include "models/contact/elastic_foundation.h"

namespace sinew {

/// A floor (half-space) and some regions, each on a free body of its own whose motion is given.
///
/// Simbody's contact parameters belong to its topology: every set of parameters gets a new system. Not
/// thread-safe; use one per thread.
class SimbodyContact {
 public:
  /// @param parameters one per region.
  SimbodyContact(const std::vector<ContactRegion>& regions, const std::vector<ElasticFoundation>& parameters,
                 double transition_velocity, double floor_height);
  ~SimbodyContact();
  SimbodyContact(SimbodyContact&&) noexcept;
  SimbodyContact& operator=(SimbodyContact&&) noexcept;

  /// Wrench of the floor on each region for these motions of their bodies (one motion per region). Errors:
  /// Simbody's own, as a sentence.
  Result<std::vector<ContactWrench>> WrenchesAt(const std::vector<BodyMotion>& motion);

 private:
  struct Simulation;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace sinew
