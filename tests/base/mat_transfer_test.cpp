#include "base/mat_transfer.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace sinew {
namespace {

MatFile Example() {
  MatFile file;
  MatValue numbers;
  numbers.shape = {3, 1};
  numbers.numbers = {1, 2.5, -3};
  numbers.integers = true;
  MatValue text;
  text.kind = MatKind::kText;
  text.shape = {1, 2};
  text.text = "Nm";
  MatValue& channel = file.variables["Torque"];
  channel.kind = MatKind::kStruct;
  channel.shape = {1, 1};
  channel.fields = {"values", "units"};
  channel.elements = {numbers, text};
  MatValue& table = file.variables["t"];
  table.kind = MatKind::kOther;
  table.other = "is a table";
  file.twice = {"Torque"};
  return file;
}

TEST(MatTransfer, UnpacksWhatWasPacked) {
  const auto file = UnpackMat(PackMat(Example()));
  ASSERT_TRUE(file);
  EXPECT_EQ(file->twice, Example().twice);
  const MatValue& channel = file->variables.at("Torque");
  EXPECT_EQ(channel.Field("values")->numbers, (std::vector<double>{1, 2.5, -3}));
  EXPECT_EQ(channel.Field("values")->shape, (std::vector<std::size_t>{3, 1}));
  EXPECT_TRUE(channel.Field("values")->integers);
  EXPECT_EQ(channel.Field("units")->text, "Nm");
  EXPECT_EQ(channel.Field("units")->kind, MatKind::kText);
  EXPECT_EQ(file->variables.at("t").other, "is a table");
  EXPECT_TRUE(UnpackMat(PackMat(MatFile())));
}

TEST(MatTransfer, BytesThatAreNotWholeAreRefused) {
  const std::string bytes = PackMat(Example());
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(UnpackMat(bytes.substr(0, length)));
  EXPECT_FALSE(UnpackMat(bytes + '\0'));
}

TEST(MatTransfer, ChangedBytesAreRefusedOrConsistent) {
  const std::string valid = PackMat(Example());
  Random random(5);
  int refused = 0;
  constexpr int kChanges = 20000;
  for (int i = 0; i < kChanges; ++i) {
    std::string bytes = valid;
    bytes[random.Index(bytes.size())] = static_cast<char>(random.Index(256));
    const auto file = UnpackMat(bytes);
    if (!file) ++refused;
    if (!file) continue;
    for (const auto& [name, value] : file->variables) {
      if (value.kind != MatKind::kStruct) continue;
      EXPECT_EQ(value.elements.size(), value.count() * value.fields.size());
    }
  }
  EXPECT_GT(refused, kChanges / 4);
}

}  // namespace
}  // namespace sinew
