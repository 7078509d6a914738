// What has become of the steps of one subject: kept beside its results, so that what is done is not done
// again.
#pragma once

#include <map>
#include <string>

#include "base/error.h"

namespace sinew::cohort {

enum class Progress { kBegun, kDone, kFailed };

struct StepRecord {
  Progress progress = Progress::kBegun;
  std::string question;                        ///< digest of version, words and contents of what is read
  std::map<std::string, std::string> written;  ///< digest of every file that was written; "" of a folder
  double seconds = 0;
  std::string reason;  ///< kFailed: why
};

/// The file FOLDER/steps.json.
class StepStates {
 public:
  /// Empty if there is no such file. Errors: it is not one of ours.
  static Result<StepStates> Read(const std::string& folder);

  [[nodiscard]] const StepRecord* Find(const std::string& step) const;
  /// Replaces the record and the file.
  Status Set(const std::string& step, StepRecord record);

 private:
  explicit StepStates(std::string path) : path_(std::move(path)) {}

  std::string path_;
  std::map<std::string, StepRecord> records_;
};

/// Digest of a file's bytes, in hexadecimal digits. Errors: those of ReadFile.
Result<std::string> DigestOfFile(const std::string& path);

}  // namespace sinew::cohort
