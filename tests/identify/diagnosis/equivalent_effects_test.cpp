// Effects that do what a cause does are alternatives of it, also where no search has fitted them.
#include "identify/diagnosis/select/equivalent_effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/identify/diagnosis/linear_laws.h"
#include "tests/identify/support/error_of.h"

namespace sinew::diagnosis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

/// A diagnosis whose selection has ended with these causes, and without any rival.
class Selected {
 public:
  /// @param tied another effect that counts as fitting as well as the last cause
  Selected(const LinearLaws::Truth& truth, const std::vector<std::string>& causes,
           bool cross_validated = false, const std::string& tied = "")
      : problem_(truth, 3), state(problem_, options_) {
    const FitSetup setup = MakeFitSetup(problem_, {}).value();
    state.candidates = ListCandidates(problem_, setup);
    state.refitter = std::make_unique<Refitter>(problem_, setup, state.candidates);
    state.base.refit = state.refitter->Fit({}, {RestPoint(problem_)});
    state.selection.cross_validated = cross_validated;
    std::vector<int> released;
    for (const std::string& name : causes) released.push_back(Candidate(name));
    std::sort(released.begin(), released.end());
    state.selection.model = state.Fit(released, {state.base.refit.point});
    for (const std::string& name : causes) state.selection.causes.push_back({Candidate(name), 100, 0, 0});
    if (!tied.empty()) {
      Rival rival{Candidate(tied), Candidate(causes.back()), state.selection.model, 1e-5, 1};
      rival.left_out = 1 + 1e-7;
      state.selection.rivals.push_back(std::move(rival));
    }
    EXPECT_EQ(ErrorOf(AddEquivalentEffects(state)), "");
  }

  [[nodiscard]] int Candidate(const std::string& name) const {
    for (std::size_t c = 0; c < state.candidates.size(); ++c) {
      if (state.candidates[c].effect == name) return static_cast<int>(c);
    }
    ADD_FAILURE() << name;
    return 0;
  }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> Rivals() const {
    std::vector<std::pair<std::string, std::string>> names;
    for (const Rival& rival : state.selection.rivals)
      names.emplace_back(state.candidate(rival.instead_of).effect, state.candidate(rival.candidate).effect);
    return names;
  }

 private:
  LinearLaws problem_;
  DiagnosisOptions options_;

 public:
  DiagnosisState state;
};

LinearLaws::Truth StepOf(double size, double noise) {
  LinearLaws::Truth truth;
  truth.effects = {{"step_size", size}, {"drift_size", 0.5}};
  truth.noise = noise;
  return truth;
}

TEST(EquivalentEffects, OneThatDoesTheSameIsAnAlternative) {
  // The twin differs from what of the step the base model leaves by a tenth, far less than the noise.
  const Selected one(StepOf(0.5, 1), {"drift", "step"});
  ASSERT_THAT(one.Rivals(), ElementsAre(Pair("step", "twin")));
  const Rival& twin = one.state.selection.rivals.front();
  EXPECT_GT(twin.correlation, 0.99);
  EXPECT_LE(std::abs(twin.delta_lr), SetWidth(one.state.selection.model));
}

TEST(EquivalentEffects, OneThatTheDataTellApartIsNone) {
  // Now it is 12 times the noise of the whole record.
  EXPECT_THAT(Selected(StepOf(2, 0.1), {"drift", "step"}).Rivals(), IsEmpty());
}

TEST(EquivalentEffects, WhereCausesAreCrossValidatedThePredictionsAreCompared) {
  LinearLaws::Truth truth = StepOf(0.5, 0.01);
  truth.slow_error = 1;
  const Selected one(truth, {"drift", "step"}, true);
  ASSERT_THAT(one.Rivals(), ElementsAre(Pair("step", "twin")));
  EXPECT_NEAR(one.state.selection.rivals.front().left_out, 1, 0.05);
  EXPECT_TRUE(std::isnan(one.state.selection.rivals.front().delta_lr));
}

TEST(EquivalentEffects, OfTwoThatOnlyRoundingTellsApartTheFirstOfTheLibraryIsTheCause) {
  for (const bool cross_validated : {false, true}) {
    for (const bool twin_first : {false, true}) {
      const Selected one(StepOf(2, 0.1), {"drift", twin_first ? "twin" : "step"}, cross_validated,
                         twin_first ? "step" : "twin");
      ASSERT_LT(one.Candidate("step"), one.Candidate("twin"));
      EXPECT_EQ(one.state.selection.causes.back().candidate, one.Candidate("step"));
      EXPECT_THAT(one.Rivals(), testing::Contains(Pair("step", "twin")));
    }
  }
}

TEST(EquivalentEffects, ASimplerOneThatExplainsAsMuchTakesTheCausesPlace) {
  LinearLaws::Truth truth;
  truth.effects = {{"quadratic_size", 0.5}};
  truth.lopsided = true;  // two sizes, of which the truth needs one
  const Selected one(truth, {"lopsided"});
  ASSERT_EQ(one.state.selection.causes.size(), 1U);
  EXPECT_EQ(one.state.selection.causes[0].candidate, one.Candidate("quadratic"));
  EXPECT_EQ(one.state.selection.model.released, std::vector<int>{one.Candidate("quadratic")});
  EXPECT_THAT(one.Rivals(), ElementsAre(Pair("quadratic", "lopsided")));
}

}  // namespace
}  // namespace sinew::diagnosis
