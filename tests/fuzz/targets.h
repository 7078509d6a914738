// What is fuzzed: one function for each reader of files and words, and what must hold of whatever it returns.
//
// Each takes any bytes. It ends the process (Demand), or a sanitizer does, where a reader has a fault; it
// returns where the bytes were read, or refused by an Error. README.md has the list and how it is run.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew::fuzz {

void Trc(std::string_view bytes);
void Storage(std::string_view bytes);
void Csv(std::string_view bytes);
void CsvImport(std::string_view bytes);  ///< a map and a table, separated by kSeparator
void ImportMap(std::string_view bytes);
void ExternalLoads(std::string_view bytes);
void Units(std::string_view bytes);  ///< of a unit, --plates, a path within a MAT file

void Osim(std::string_view bytes);  ///< as a mechanism, with its muscles, moved
void IkSetup(std::string_view bytes);
void Obj(std::string_view bytes);
void MechanismReference(std::string_view bytes);

void CeinmsSubject(std::string_view bytes);
void CeinmsCalibration(std::string_view bytes);  ///< an execution too
void CeinmsProject(std::string_view bytes);      ///< setup, excitation generator and trial
void CeinmsRtCalibration(std::string_view bytes);
void CeinmsRtEmg(std::string_view bytes);
void CeinmsRtExecution(std::string_view bytes);

void AnkleSettings(std::string_view bytes);
void ContactSettings(std::string_view bytes);
void DriveSettings(std::string_view bytes);
void EmgShapeSettings(std::string_view bytes);
void FreeBodySettings(std::string_view bytes);
void NmsSettings(std::string_view bytes);

void Hdf5File(std::string_view bytes);
void MatFile(std::string_view bytes);
void DatasetFile(std::string_view bytes);  ///< a tree of groups and values (tree_text.h), as a file
void RunFile(std::string_view bytes);      ///< the same; a diagnosis is one too
void StudyFile(std::string_view bytes);    ///< the same

void Pipeline(std::string_view bytes);
void Words(std::string_view bytes);  ///< of a command line, one a line
void StepStates(std::string_view bytes);

struct Target {
  const char* name;  ///< of its program, fuzz_NAME, and of its folder in corpus/
  void (*run)(std::string_view bytes);
};

/// All of them.
[[nodiscard]] const std::vector<Target>& Targets();

/// Parts of an input that stands for several files.
constexpr std::string_view kSeparator = "\n====\n";
/// @return so many parts; those that are absent are empty.
[[nodiscard]] std::vector<std::string> Parts(std::string_view bytes, std::size_t count);

/// Ends the process unless the condition holds: a fault of a reader.
void Demand(bool condition, const char* what);

/// An error is a sentence that begins with the place that it is about.
void DemandSentence(const Error& error, const std::string& place);

/// The same of a Result or a Status, where it holds an error. @return whether it holds a value
template <class T>
bool Holds(const Result<T>& result, const std::string& place) {
  if (!result) DemandSentence(result.error(), place);
  return result.has_value();
}

/// A folder of this process below TMPDIR (run.py: in memory), which is removed at its end.
[[nodiscard]] const std::string& ScratchFolder();
/// Writes a file of it. @return its path
std::string Scratch(const std::string& name, std::string_view bytes);

}  // namespace sinew::fuzz
