#include "models/emg/butterworth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kRate = 2048;
constexpr double kRounding = 1e-11;  // of a gain: eps (rate / cut-off)^2 at 6 Hz

double Gain(const FilterSections& sections, double frequency_Hz, double rate_Hz = kRate) {
  const auto z = std::polar(1.0, -2 * kPi * frequency_Hz / rate_Hz);  // of one step back
  std::complex<double> gain = 1;
  for (const FilterSection& s : sections)
    gain *= (s.b0 + z * (s.b1 + z * s.b2)) / (1.0 + z * (s.a1 + z * s.a2));
  return std::abs(gain);
}

// |H|^2 = 1 / (1 + (tan(pi f / rate) / tan(pi cut_off / rate))^(2 n)).
TEST(ButterworthTest, AmplitudeIsTheFormula) {
  for (const int order : {1, 2, 3, 4, 7, 8, 16}) {
    for (const double cut_off : {6.0, 30.0, 300.0, 1000.0}) {
      const auto low = ButterworthLowPass(order, cut_off, kRate);
      const auto high = ButterworthHighPass(order, cut_off, kRate);
      ASSERT_TRUE(low && high);
      EXPECT_EQ(low->size(), static_cast<std::size_t>((order + 1) / 2));
      for (const double f : {1.0, 6.0, 25.0, 30.0, 200.0, 999.0}) {
        const double ratio = std::tan(kPi * f / kRate) / std::tan(kPi * cut_off / kRate);
        EXPECT_NEAR(Gain(*low, f), 1 / std::sqrt(1 + std::pow(ratio, 2 * order)), order * kRounding);
        EXPECT_NEAR(Gain(*high, f), 1 / std::sqrt(1 + std::pow(ratio, -2 * order)), order * kRounding);
      }
      EXPECT_NEAR(Gain(*low, 0), 1, order * kRounding);
      EXPECT_EQ(Gain(*high, 0), 0);
    }
  }
}

TEST(ButterworthTest, BandPassEndsAtItsEdges) {
  for (const int order : {1, 2, 3, 4}) {
    const auto band = ButterworthBandPass(order, 20, 450, kRate);
    ASSERT_TRUE(band);
    EXPECT_EQ(band->size(), static_cast<std::size_t>(order));
    EXPECT_NEAR(Gain(*band, 20), std::sqrt(0.5), kRounding);
    EXPECT_NEAR(Gain(*band, 450), std::sqrt(0.5), kRounding);
    EXPECT_EQ(Gain(*band, 0), 0);
    const double middle =
        kRate / kPi * std::atan(std::sqrt(std::tan(kPi * 20 / kRate) * std::tan(kPi * 450 / kRate)));
    EXPECT_NEAR(Gain(*band, middle), 1, kRounding);
  }
}

// The filters of a published execution of CEINMS-RT (executionEMG.xml, doi 10.5281/zenodo.6457662), one pass
// of order 2 at 0.05 and 0.002 of the rate, printed with eight decimals.
TEST(ButterworthTest, MakesTheFiltersOfCeinmsRt) {
  const FilterSection high = ButterworthHighPass(2, 0.05, 1)->front();
  EXPECT_NEAR(high.a1, -1.56101808, 1e-8);
  EXPECT_NEAR(high.a2, 0.64135154, 1e-8);
  EXPECT_NEAR(high.b0, 0.8005924, 1e-8);
  EXPECT_NEAR(high.b1, -1.60118481, 1e-8);
  const FilterSection low = ButterworthLowPass(2, 0.002, 1)->front();
  EXPECT_NEAR(low.a1, -1.98222893, 1e-8);
  EXPECT_NEAR(low.a2, 0.98238545, 1e-8);
  EXPECT_NEAR(low.b0, 3.91302054e-05, 1e-13);
  EXPECT_NEAR(low.b1, 7.82604108e-05, 1e-13);
}

TEST(ButterworthTest, EverySectionIsStable) {
  for (int order = 1; order <= kHighestFilterOrder; ++order) {
    for (const double share : {1e-5, 1e-3, 0.1, 0.4999}) {
      for (const auto& made :
           {ButterworthLowPass(order, share * kRate, kRate), ButterworthHighPass(order, share * kRate, kRate),
            ButterworthBandPass(order, 0.5 * share * kRate + 0.01, share * kRate, kRate)}) {
        if (!made) continue;  // the band's lower edge may lie outside
        for (const FilterSection& s : *made) {
          EXPECT_LT(std::abs(s.a2), 1);
          EXPECT_LT(std::abs(s.a1), 1 + s.a2);
        }
      }
    }
  }
}

TEST(ButterworthTest, RejectsWhatHasNoMeaning) {
  const auto message = [](const Result<FilterSections>& made) { return made ? "" : made.error().message; };
  EXPECT_EQ(message(ButterworthLowPass(0, 6, kRate)), "filter of order 0: expected 1 to 16");
  EXPECT_EQ(message(ButterworthHighPass(17, 6, kRate)), "filter of order 17: expected 1 to 16");
  EXPECT_EQ(message(ButterworthLowPass(2, 6, -1)), "sampling rate -1 Hz: expected more than 0");
  EXPECT_EQ(message(ButterworthLowPass(2, 6, NAN)), "sampling rate nan Hz: expected more than 0");
  const std::string range =
      "at a sampling rate of 1000 Hz: expected at least 0.01 Hz and less than half of the rate, 500 Hz";
  EXPECT_EQ(message(ButterworthHighPass(2, 500, 1000)), "cut-off 500 Hz " + range);
  EXPECT_EQ(message(ButterworthHighPass(2, 0, 1000)), "cut-off 0 Hz " + range);
  EXPECT_EQ(message(ButterworthLowPass(2, NAN, 1000)), "cut-off nan Hz " + range);
  EXPECT_EQ(message(ButterworthBandPass(2, 450, 20, kRate)),
            "pass band from 450 to 20 Hz: expected an end above its start");
}

}  // namespace
}  // namespace sinew
