// The text of datasets/data/nao_like.osim, so that synthetic data can be made wherever the program is.
#pragma once

#include <string>

namespace sinew {

extern const std::string kNaoLikeOsim;

}  // namespace sinew
