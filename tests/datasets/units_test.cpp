#include "datasets/units.h"

#include "base/constants.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

constexpr double kFactorRounding = 1e-15;  // a handful of multiplications, relative

struct Case {
  const char* written;
  const char* si;
  double factor;
};

TEST(Units, KnownUnitsBecomeSi) {
  const Case cases[] = {
      {"m", "m", 1},
      {"mm", "m", 1e-3},
      {"cm", "m", 1e-2},
      {"deg", "rad", kPi / 180},
      {"\xC2\xB0", "rad", kPi / 180},
      {"deg/s", "rad/s", kPi / 180},
      {"deg/s^2", "rad/s2", kPi / 180},
      {"ms", "s", 1e-3},
      {"N*m", "N*m", 1},
      {"N m", "N*m", 1},
      {"Nm", "N*m", 1},
      {"N.m", "N*m", 1},
      {"N\xC2\xB7m", "N*m", 1},
      {"m*N", "N*m", 1},
      {"N*mm", "N*m", 1e-3},
      {"Nmm", "N*m", 1e-3},
      {"rpm", "rad/s", kPi / 30},
      {"mV", "V", 1e-3},
      {"uV", "V", 1e-6},
      {"\xC2\xB5V", "V", 1e-6},
      {"%", "1", 0.01},
      {"1", "1", 1},
      {"1/s", "1/s", 1},
      {"m/s^2", "m/s2", 1},
      {"m/s2", "m/s2", 1},
      {"m s^-2", "m/s2", 1},
      {"m/s\xC2\xB2", "m/s2", 1},
      {"N/m3", "N/m3", 1},
      {"N/mm", "N/m", 1e3},
      {"N/cm^2", "N/m2", 1e4},
      {"Nm/deg", "N*m/rad", 180 / kPi},
      {"V/rpm", "V*s/rad", 30 / kPi},
      {"N*m/(rad/s)", "N*m*s/rad", 1},
      {"kg*m^2", "kg*m2", 1},
      {" N / m ", "N/m", 1},
      {"kPa", "Pa", 1e3},
  };
  for (const Case& expected : cases) {
    const auto conversion = ToSi(expected.written);
    ASSERT_TRUE(conversion) << expected.written << ": " << ErrorOf(conversion);
    EXPECT_EQ(conversion->si_unit, expected.si) << expected.written;
    EXPECT_NEAR(conversion->factor / expected.factor, 1, kFactorRounding) << expected.written;
  }
}

TEST(Units, SiUnitsConvertToThemselves) {
  for (const char* unit :
       {"m", "s",  "rad", "N",         "N*m",   "N/m3",    "m/s", "rad/s", "rad/s2", "V",
        "A", "kg", "1",   "N*m*s/rad", "kg*m2", "N/(m*s)", "Hz",  "ohm",   "s/m",    "N*m2/s9"}) {
    const auto conversion = ToSi(unit);
    ASSERT_TRUE(conversion) << unit;
    EXPECT_EQ(conversion->si_unit, unit);
    EXPECT_EQ(conversion->factor, 1) << unit;
  }
}

TEST(Units, DegreesCelsiusBecomeKelvin) {
  for (const char* unit : {"degC", " degC ",
                           "\xC2\xB0"
                           "C"}) {
    const auto conversion = ToSi(unit);
    ASSERT_TRUE(conversion) << unit << ": " << ErrorOf(conversion);
    EXPECT_EQ(conversion->si_unit, "K");
    EXPECT_EQ(conversion->factor, 1);
    EXPECT_EQ(conversion->ToSi(20), 293.15);
  }
  EXPECT_EQ(ToSi("K")->ToSi(20), 20);
  EXPECT_EQ(ToSi("N*m/K")->si_unit, "N*m/K");
  EXPECT_FALSE(ToSi("N*m/degC"));  // a difference or a temperature?
}

TEST(Units, UnknownUnitsAreErrorsThatListTheKnown) {
  EXPECT_THAT(ErrorOf(ToSi("furlong")), testing::AllOf(testing::HasSubstr("unknown unit 'furlong'"),
                                                       testing::HasSubstr("deg"), testing::HasSubstr("rpm")));
  EXPECT_THAT(ErrorOf(ToSi("degs")), testing::HasSubstr("did you mean 'deg'?"));
  EXPECT_THAT(ErrorOf(ToSi("  ")), testing::HasSubstr("empty"));
  for (const char* unit : {"N*", "/s", "m^", "m^x", "(m", "m)", "m//s", "m2s", "m^12", "2", "N**m", "m^-",
                           "((((((((((m))))))))))", "m9*m", "((((((((m9)9)9)9)9)9)9)9)9*m9", "1/(s5*s5)"}) {
    EXPECT_FALSE(ToSi(unit)) << unit;
  }
  EXPECT_FALSE(ToSi(std::string(1000, 'm')));
}

}  // namespace
}  // namespace sinew
