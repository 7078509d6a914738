// What is compared and predicted: the blocks of a drive, and their weights.
#pragma once

#include <string>
#include <vector>

#include "problems/drive/data/data.h"
#include "problems/drive/data/starts.h"

namespace sinew {

/// Adds the blocks of a trial. @param fit channels that are compared. @param run index into out.runs.
/// Errors: a channel in another unit than that of the joint, a channel to be fitted without samples.
Status AddBlocks(const Trial& trial, const std::vector<std::string>& fit, int run, const DriveMotion& motion,
                 double margin, DriveData& out);

/// Sets the weights of all blocks and the scale of the noise.
/// Errors: a fitted channel that does not vary.
Status WeighBlocks(const std::vector<std::string>& fit, DriveData& out);

}  // namespace sinew
