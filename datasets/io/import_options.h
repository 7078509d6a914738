// What a person says about the files that are imported.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "datasets/io/external_loads.h"
#include "datasets/io/import_map.h"
#include "datasets/io/plates.h"
#include "datasets/io/storage_content.h"

namespace sinew {

struct ImportOptions {
  std::string trial;         ///< empty: the name of the first file with data, without its extension
  std::optional<Role> role;  ///< not given: that of the trial, if it exists, else train
  bool append = false;       ///< the trial may exist already and gets further grids
  std::optional<ImportMap> map;
  std::vector<PlatePrefix> plates;            ///< `--plates`
  std::vector<ExternalForce> external_loads;  ///< `--external-loads`; a force's name becomes the plate's
  CoordinateKindOf coordinate_kind;           ///< from the model, if there is one
};

}  // namespace sinew
