// Damaged files: every parser must return, with a result or an error, whatever the bytes.
#include <functional>

#include "base/random.h"
#include "datasets/dataset.h"
#include "datasets/io/csv_file.h"
#include "datasets/io/external_loads.h"
#include "datasets/io/import_map.h"
#include "datasets/io/plates.h"
#include "datasets/io/storage_file.h"
#include "datasets/io/trc_file.h"
#include "datasets/units.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

constexpr int kMutants = 4000;  // per parser; a few seconds in all

std::string Mutate(std::string text, Random& random) {
  const auto edits = 1 + random.Index(4);
  for (std::uint64_t i = 0; i < edits && !text.empty(); ++i) {
    const std::size_t at = random.Index(text.size());
    switch (random.Index(6)) {
      case 0:  // any byte
        text[at] = static_cast<char>(random.Index(256));
        break;
      case 1:  // one bit
        text[at] = static_cast<char>(text[at] ^ (1 << random.Index(8)));
        break;
      case 2:  // cut off
        text.resize(at);
        break;
      case 3: {  // a line twice
        const auto begin = text.rfind('\n', at);
        const auto first = begin == std::string::npos ? 0 : begin + 1;
        const auto end = std::min(text.find('\n', at), text.size() - 1);
        text.insert(first, text.substr(first, end + 1 > first ? end + 1 - first : 0));
        break;
      }
      case 4:  // some bytes less
        text.erase(at, 1 + random.Index(8));
        break;
      default:  // numbers that are too much
        text.insert(at, random.Index(2) == 0 ? "99999999999999999999" : "1e308");
        break;
    }
  }
  return text;
}

// Returns how many mutants the parser refused.
int Fuzz(const std::string& valid, std::uint64_t seed,
         const std::function<bool(const std::string&)>& accepts) {
  EXPECT_TRUE(accepts(valid));
  Random random(seed);
  int refused = 0;
  for (int i = 0; i < kMutants; ++i) refused += accepts(Mutate(valid, random)) ? 0 : 1;
  for (std::size_t length = 0; length < valid.size(); ++length) accepts(valid.substr(0, length));
  return refused;
}

TEST(Fuzz, Storage) {
  const std::string valid =
      "Coordinates\nversion=1\nnRows=6\nnColumns=3\ninDegrees=yes\n\nendheader\ntime\tknee\tankle\n"
      "0.000\t1\t2\n0.017\t1\t2\n0.033\t1\t2\n0.050\tnan\t2\n0.067\t1e-3\t2\n0.083\t1\t2\n";
  const auto accepts = [](const std::string& text) {
    const auto storage = ParseStorage(text, "x.mot");
    if (!storage) {
      EXPECT_THAT(ErrorOf(storage), testing::StartsWith("x.mot"));
      return false;
    }
    for (const auto& column : storage->columns) EXPECT_EQ(column.size(), storage->time.size());
    EXPECT_EQ(storage->names.size(), storage->columns.size());
    for (std::size_t i = 1; i < storage->time.size(); ++i) EXPECT_LT(storage->time[i - 1], storage->time[i]);
    return true;
  };
  EXPECT_GT(Fuzz(valid, 1, accepts), kMutants / 4);
}

TEST(Fuzz, Trc) {
  const std::string valid =
      "PathFileType\t4\t(X/Y/"
      "Z)\tw.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n60\t60\t4\t2\tmm\n"
      "Frame#\tTime\tA\t\t\tB\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n"
      "1\t0.000\t1\t2\t3\t4\t5\t6\n2\t0.017\t1\t2\t3\t\t\t\n3\t0.033\t1\t2\t3\t4\t5\t6\n4\t0."
      "050\t1\t2\t3\t4\t5\t6\n";
  const auto accepts = [](const std::string& text) {
    const auto trc = ParseTrc(text, "x.trc");
    if (!trc) {
      EXPECT_THAT(ErrorOf(trc), testing::StartsWith("x.trc"));
      return false;
    }
    for (const auto& marker : trc->markers) {
      EXPECT_EQ(static_cast<std::size_t>(marker.position.rows()), trc->time.size());
    }
    for (std::size_t i = 1; i < trc->time.size(); ++i) EXPECT_LT(trc->time[i - 1], trc->time[i]);
    return true;
  };
  EXPECT_GT(Fuzz(valid, 2, accepts), kMutants / 4);
}

TEST(Fuzz, Csv) {
  const std::string valid = "# log\n\"time, s\",q,mode\n0,1.5,on\n1,,off\n2,nan,\"o\"\"n\"\n3,4e-2,on\n";
  const auto accepts = [](const std::string& text) {
    const auto table = ParseCsv(text, "x.csv");
    if (!table) return false;
    for (const auto& column : table->columns) EXPECT_EQ(column.values.size(), table->lines.size());
    return true;
  };
  EXPECT_GT(Fuzz(valid, 3, accepts), kMutants / 10);
}

TEST(Fuzz, ImportMap) {
  const std::string valid =
      "time: {column: t, unit: s}\nchannels:\n  position: {column: qm, unit: deg, kind: measured, scale: "
      "1.0}\n"
      "  torque: &a\n    column: tau\n    unit: N*m\nmarkers: {R.ASIS: RASI}\n"
      "constants: {gear_ratio: {value: 120, unit: \"1\"}}\nconditions: {speed_rad_per_s: 0.52}\n";
  const auto accepts = [](const std::string& text) { return ParseImportMap(text, "m.yaml").has_value(); };
  EXPECT_GT(Fuzz(valid, 4, accepts), kMutants / 4);
}

TEST(Fuzz, ExternalLoads) {
  const std::string valid =
      "<?xml version=\"1.0\" encoding=\"UTF-8\" ?>\n<OpenSimDocument Version=\"30000\">\n<ExternalLoads "
      "name=\"g\">\n"
      "<objects>\n<ExternalForce name=\"right\">\n<!-- a comment "
      "-->\n<applied_to_body>calcn_r</applied_to_body>\n"
      "<force_identifier>ground_force_v</force_identifier>\n<point_identifier>ground_force_p</"
      "point_identifier>\n"
      "</ExternalForce>\n</objects>\n</ExternalLoads>\n</OpenSimDocument>\n";
  const auto accepts = [](const std::string& text) { return ParseExternalLoads(text, "x.xml").has_value(); };
  EXPECT_GT(Fuzz(valid, 5, accepts), kMutants / 4);
}

TEST(Fuzz, UnitsAndPlates) {
  const auto unit = [](const std::string& text) { return ToSi(text).has_value(); };
  EXPECT_GT(Fuzz("N*m/(rad/s)^2", 6, unit), kMutants / 4);
  const auto plates = [](const std::string& text) { return ParsePlates(text).has_value(); };
  EXPECT_GT(Fuzz("right=ground_,left=1_ground_", 7, plates), kMutants / 20);
}

// Nesting is what makes recursive parsers run out of stack.
TEST(Fuzz, DeepNesting) {
  constexpr std::size_t kDeep = 200000;
  EXPECT_FALSE(ToSi(std::string(kDeep, '(')));
  EXPECT_FALSE(ParseImportMap(std::string(kDeep, '['), "m.yaml"));
  EXPECT_FALSE(ParseImportMap(std::string(kDeep, '{'), "m.yaml"));
  std::string xml;
  for (std::size_t i = 0; i < kDeep; ++i) xml += "<a>";
  EXPECT_FALSE(ParseExternalLoads(xml, "x.xml"));
  for (std::size_t i = 0; i < kDeep; ++i) xml += "</a>";
  EXPECT_FALSE(ParseExternalLoads(xml, "x.xml"));
}

}  // namespace
}  // namespace sinew
