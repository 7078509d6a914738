#include "models/multibody/ik_setup.h"

#include <cmath>

#include "base/text.h"
#include "models/multibody/osim_xml.h"

namespace sinew {
namespace {

// The part that markers and coordinates share.
template <class Task>
Status ReadTask(const OsimXml& xml, const pugi::xml_node& element, Task& task) {
  task.name = NameOf(element);
  SINEW_ASSIGN(task.apply, xml.Flag(element, "apply", true));
  SINEW_ASSIGN(task.weight, xml.Number(element, "weight", 1));
  if (!(task.weight >= 0) || std::isinf(task.weight)) {
    return xml.FailAt(element.child("weight"), "weight of {} '{}' is {}, expected a finite number >= 0",
                      element.name(), task.name, task.weight);
  }
  return {};
}

Result<IkSetup::CoordinateTask> ReadCoordinateTask(const OsimXml& xml, const pugi::xml_node& element) {
  IkSetup::CoordinateTask task;
  SINEW_TRY(ReadTask(xml, element, task));
  const std::string target = Lowercase(ChildText(element, "value_type"));
  if (target.empty() || target == "default_value") {
    task.target = IkSetup::Target::kDefaultValue;
  } else if (target == "manual_value") {
    task.target = IkSetup::Target::kManualValue;
  } else if (target == "from_file") {
    task.target = IkSetup::Target::kFromFile;
  } else {
    return xml.FailAt(element.child("value_type"),
                      "value_type is '{}', expected default_value, manual_value or from_file", target);
  }
  SINEW_ASSIGN(task.value, xml.Number(element, "value", 0));
  if (!std::isfinite(task.value)) return xml.FailAt(element.child("value"), "value is not finite");
  return task;
}

}  // namespace

Result<IkSetup> ReadIkSetup(std::string_view text, const std::string& file_name) {
  SINEW_ASSIGN(const OsimXml xml, OsimXml::Parse(text, file_name));
  const pugi::xml_node tool = xml.root().child("InverseKinematicsTool");
  const pugi::xml_node tasks = (tool ? tool : xml.root()).child("IKTaskSet");
  if (!tasks) {
    return xml.FailAt(xml.root(),
                      "there is no <IKTaskSet>; expected an OpenSim inverse kinematics setup file");
  }
  if (tasks.attribute("file")) {
    return xml.FailAt(tasks, "the tasks stand in another file, '{}': use that one",
                      tasks.attribute("file").value());
  }
  IkSetup setup;
  for (const pugi::xml_node& element : Members(tasks)) {
    const std::string_view kind = element.name();
    if (kind == "IKMarkerTask") {
      IkSetup::MarkerTask task;
      SINEW_TRY(ReadTask(xml, element, task));
      setup.markers.push_back(std::move(task));
    } else if (kind == "IKCoordinateTask") {
      SINEW_ASSIGN(IkSetup::CoordinateTask task, ReadCoordinateTask(xml, element));
      setup.coordinates.push_back(std::move(task));
    } else {
      return xml.FailAt(element,
                        "task {} '{}' is not supported; supported are IKMarkerTask and IKCoordinateTask",
                        kind, NameOf(element));
    }
  }
  if (setup.markers.empty()) return xml.FailAt(tasks, "the IKTaskSet has no IKMarkerTask");
  SINEW_ASSIGN(const std::vector<double> range, xml.Numbers(tool, "time_range"));
  if (tool.child("time_range")) {
    if (range.size() != 2 || !(range[0] <= range[1]))
      return xml.FailAt(tool.child("time_range"), "time_range is not a first and a last time");
    setup.start_time = range[0];
    setup.end_time = range[1];
  }
  return setup;
}

}  // namespace sinew
