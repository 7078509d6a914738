#include "datasets/io/dataset_file.h"

#include <cmath>

#include "base/hdf5_tree.h"
#include "datasets/dataset_hash.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::HasSubstr;

TEST(DatasetFile, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  const Dataset dataset = SmallDataset();
  ASSERT_EQ(ErrorOf(WriteDataset(folder.Path("d.h5"), dataset)), "");
  const auto read = ReadDataset(folder.Path("d.h5"));
  ASSERT_TRUE(read) << ErrorOf(read);
  EXPECT_EQ(DatasetHash(*read), DatasetHash(dataset));
  const auto found = read->trials.at("walk").Find("right_force_y");
  EXPECT_TRUE(std::isnan(found.channel->values[2]));
  EXPECT_EQ(found.channel->sigma, 2.5);
  EXPECT_EQ(read->licence, "CC BY 4.0");
  EXPECT_EQ(read->trials.at("walk").cut_from, "recording");
}

TEST(DatasetFile, AnEmptyDatasetAndEmptyTextsSurvive) {
  const TemporaryFolder folder;
  ASSERT_EQ(ErrorOf(WriteDataset(folder.Path("d.h5"), {})), "");
  const auto read = ReadDataset(folder.Path("d.h5"));
  ASSERT_TRUE(read) << ErrorOf(read);
  EXPECT_EQ(DatasetHash(*read), DatasetHash({}));
}

TEST(DatasetFile, ABadDatasetIsNotWritten) {
  const TemporaryFolder folder;
  Dataset dataset = SmallDataset();
  dataset.constants["body_mass"].unit = "stone";
  EXPECT_THAT(ErrorOf(WriteDataset(folder.Path("d.h5"), dataset)),
              HasSubstr("/constants/body_mass: unknown unit"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("d.h5")));
}

// The tree of SmallDataset, written by hand as another program would.
class DatasetFileTree : public testing::Test {
 protected:
  DatasetFileTree() {
    EXPECT_EQ(ErrorOf(WriteDataset(path_, SmallDataset())), "");
    tree_ = *ReadHdf5(path_);
  }
  Result<Dataset> Reread() {
    EXPECT_EQ(ErrorOf(WriteHdf5(path_, tree_)), "");
    return ReadDataset(path_);
  }
  Hdf5Node& Force() { return tree_.At("trials/walk/forces/channels/right_force_y"); }

  TemporaryFolder folder_;
  std::string path_ = folder_.Path("d.h5");
  Hdf5Node tree_;
};

TEST_F(DatasetFileTree, UnitsBecomeSi) {
  Force().attributes["unit"] = std::string("kN");
  tree_.At("trials/walk/forces/time").attributes["unit"] = std::string("ms");
  tree_.At("constants/body_mass").attributes["unit"] = std::string("%");
  const auto read = Reread();
  ASSERT_TRUE(read) << ErrorOf(read);
  const Grid& forces = read->trials.at("walk").grids.at("forces");
  EXPECT_EQ(forces.time[4], 1e-3);
  EXPECT_EQ(forces.channels.at("right_force_y").unit, "N");
  EXPECT_EQ(forces.channels.at("right_force_y").values[1], 1e4);
  EXPECT_EQ(forces.channels.at("right_force_y").sigma, 2500);
  EXPECT_DOUBLE_EQ(read->constants.at("body_mass").value, 0.726);
}

TEST_F(DatasetFileTree, VectorsAndScalarsMayHaveMatlabsShapes) {
  tree_.At("trials/walk/forces/time").SetMatrix(1, 5, {0, 1, 2, 3, 4});
  Force().SetMatrix(5, 1, {0, 1, 2, 3, 4});
  tree_.At("constants/body_mass").SetMatrix(1, 1, {70});
  const auto read = Reread();
  ASSERT_TRUE(read) << ErrorOf(read);
  EXPECT_EQ(read->trials.at("walk").grids.at("forces").time[4], 4);
  EXPECT_EQ(read->constants.at("body_mass").value, 70);
}

TEST_F(DatasetFileTree, EveryDeviationIsAnErrorThatNamesItsPlace) {
  const std::string force = "/trials/walk/forces/channels/right_force_y: ";
  const auto text = [](const char* value) { return Hdf5Attribute(std::string(value)); };
  using Spoil = std::function<void(Hdf5Node&)>;
  const auto at_force = [](const std::function<void(Hdf5Node&)>& spoil) {
    return [spoil](Hdf5Node& root) { spoil(root.At("trials/walk/forces/channels/right_force_y")); };
  };
  const std::pair<Spoil, std::string> cases[] = {
      {[](Hdf5Node& root) { root.attributes.erase("sinew_schema"); }, "/: has no attr 'sinew_schema'"},
      {[&](Hdf5Node& root) { root.attributes["sinew_schema"] = text("run/1"); },
       "/: sinew_schema is 'run/1', expected \"dataset/1\""},
      {[](Hdf5Node& root) { root.attributes["synthetic"] = std::int64_t{2}; },
       "/: synthetic is 2, expected 0 or 1"},
      {[](Hdf5Node& root) { root.attributes["title"] = 3.0; },
       "/: attr 'title' is a number, expected a text"},
      {[&](Hdf5Node& root) { root.attributes["license"] = text("x"); },
       "/: unknown attr 'license'; did you mean 'licence'?"},
      {[](Hdf5Node& root) { root.At("trails/walk"); }, "/: unknown member 'trails'; did you mean 'trials'?"},
      {[&](Hdf5Node& root) { root.At("trials/walk").attributes["role"] = text("test"); },
       "/trials/walk: role is 'test', expected train or validate"},
      {[](Hdf5Node& root) { root.At("trials/walk").attributes.erase("role"); },
       "/trials/walk: has no attr 'role'"},
      {[&](Hdf5Node& root) { root.At("trials/walk").attributes["speed_m_per_s"] = text("fast"); },
       "/trials/walk: attr 'speed_m_per_s' is a text, expected a number"},
      {[](Hdf5Node& root) { root.At("trials/walk/forces").children.erase("time"); },
       "/trials/walk/forces: has no 'time'"},
      {[](Hdf5Node& root) { root.At("trials/walk/forces").children.erase("channels"); },
       "/trials/walk/forces: has no 'channels'"},
      {[](Hdf5Node& root) { root.At("trials/walk/forces/chanels"); },
       "/trials/walk/forces: unknown member 'chanels'"},
      {[](Hdf5Node& root) {
         root.At("trials/walk/forces/time").SetVector({0, 0.25, 0.5, 0.4, 1});
       },
       "/trials/walk/forces/time: time does not increase: sample 2 is at 0.5 s, sample 3 at 0.4 s"},
      {[](Hdf5Node& root) {
         root.At("trials/walk/forces/time").SetMatrix(2, 2, {0, 1, 2, 3});
       },
       "/trials/walk/forces/time: has 2 dimensions, expected a vector"},
      {[](Hdf5Node& root) { root.At("trials/walk/forces/time").data = std::string("now"); },
       "/trials/walk/forces/time: holds no numbers"},
      {at_force([](Hdf5Node& node) {
         node.SetVector({1, 2, 3});
       }),
       force + "has 3 values, its time has 5"},
      {at_force([](Hdf5Node& node) { node.attributes.erase("unit"); }), force + "has no attr 'unit'"},
      {at_force([&](Hdf5Node& node) { node.attributes["unit"] = text("newtons"); }),
       force + "unknown unit 'newtons'"},
      {at_force([&](Hdf5Node& node) { node.attributes["kind"] = text("output"); }),
       force + "kind is 'output', expected measured or input"},
      {at_force([](Hdf5Node& node) { node.attributes.erase("kind"); }), force + "has no attr 'kind'"},
      {at_force([](Hdf5Node& node) { node.attributes["sigma"] = -1.0; }),
       force + "sigma is -1, expected more than 0"},
      {at_force([](Hdf5Node& node) { node.attributes["sigma"] = std::string("1"); }),
       force + "attr 'sigma' is a text, expected a number"},
      {[](Hdf5Node& root) {
         root.At("constants/body_mass").SetVector({1, 2});
       },
       "/constants/body_mass: expected a single number"},
      {[](Hdf5Node& root) { root.At("files/model.osim").SetScalar(1); },
       "/files/model.osim: expected a text"},
      {[](Hdf5Node& root) {
         root.At("trials").data = std::string("x");
         root.At("trials").children.clear();
       },
       "/trials: is a dataset, expected a group"},
  };
  const Hdf5Node good = tree_;
  for (const auto& [spoil, message] : cases) {
    tree_ = good;
    spoil(tree_);
    EXPECT_THAT(ErrorOf(Reread()), HasSubstr(path_ + ": " + message)) << message;
  }
}

TEST(DatasetFile, TruncatedFilesAreErrorsAtEveryLength) {
  const TemporaryFolder folder;
  ASSERT_EQ(ErrorOf(WriteDataset(folder.Path("d.h5"), SmallDataset())), "");
  std::ifstream file(folder.Path("d.h5"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  constexpr std::size_t kStep = 61;  // bytes; hits headers, heaps and data at all offsets modulo 8
  for (std::size_t length = 0; length < bytes.size(); length += kStep) {
    const auto read = ReadDataset(folder.Write("cut.h5", bytes.substr(0, length)));
    ASSERT_FALSE(read) << length << " of " << bytes.size();
    ASSERT_THAT(ErrorOf(read), HasSubstr("cut.h5")) << length;
  }
}

TEST(DatasetFile, OtherFilesAreErrors) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(ReadDataset(folder.Path("no.h5"))), HasSubstr("no.h5: no such file"));
  EXPECT_THAT(ErrorOf(ReadDataset(folder.Write("text.h5", "time,x\n"))),
              HasSubstr("text.h5: is not an HDF5 file"));
}

}  // namespace
}  // namespace sinew
