// A sentence about a result together with what it is about, so that a program need not parse it.
#pragma once

#include <string>
#include <vector>

namespace sinew::text {

/// What a sentence tells; after the colon, what its `about` holds.
enum class SentenceKind {
  // Of an identification.
  kSummary,          ///< parameters, none by name: how many have which verdict
  kIdentifiable,     ///< parameter
  kWeak,             ///< parameter
  kOffMinimum,       ///< parameter: the value is outside of its interval, for the search did not converge
  kAtBound,          ///< parameter
  kNotIdentifiable,  ///< parameters
  kOpenDirection,    ///< parameters; none: how many such directions are left out here
  kSharedParameter,  ///< parameters that the same group has in common
  kDerived,          ///< derived quantity
  kPrediction,       ///< channel
  // Of a diagnosis.
  kInconclusive,     ///< nothing
  kAdvice,           ///< nothing
  kWithdrawn,        ///< effect
  kVerdict,          ///< nothing
  kLevel,            ///< levels that are to blame, or may be
  kCause,            ///< effect
  kAlternative,      ///< effect, the cause that it could replace
  kMoreGeneralLaw,   ///< effect, the cause that it contains
  kUnknownTerm,      ///< discrepancy term
  kParameterChange,  ///< parameter
  kNoHeldOutTrial,   ///< nothing
  kGain,             ///< channel
  kWorseTrial,       ///< trial, channel
  kWorseTrials,      ///< nothing
  kDetectable        ///< parameters
};

/// "identifiable", "weak", ...: the `kind` in JSON and HDF5.
[[nodiscard]] const char* ToString(SentenceKind kind);

struct Sentence {
  SentenceKind kind = SentenceKind::kVerdict;
  std::string text;                ///< with a full stop
  std::vector<std::string> about;  ///< names
  std::string step = {};           ///< of a stepwise fit that it is about; empty: the last, or the only one
};

/// The text of each.
[[nodiscard]] std::vector<std::string> TextsOf(const std::vector<Sentence>& sentences);

/// A sentence about an alternative, which belongs to the cause before it.
[[nodiscard]] bool IsSubordinate(const Sentence& sentence);

}  // namespace sinew::text
