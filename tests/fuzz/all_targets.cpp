#include "tests/fuzz/targets.h"

namespace sinew::fuzz {

const std::vector<Target>& Targets() {
  static const std::vector<Target> kTargets{
      {"trc", Trc},
      {"storage", Storage},
      {"csv", Csv},
      {"csv_import", CsvImport},
      {"import_map", ImportMap},
      {"external_loads", ExternalLoads},
      {"units", Units},
      {"osim", Osim},
      {"ik_setup", IkSetup},
      {"obj", Obj},
      {"mechanism_reference", MechanismReference},
      {"ceinms_subject", CeinmsSubject},
      {"ceinms_calibration", CeinmsCalibration},
      {"ceinms_project", CeinmsProject},
      {"ceinms_rt_calibration", CeinmsRtCalibration},
      {"ceinms_rt_emg", CeinmsRtEmg},
      {"ceinms_rt_execution", CeinmsRtExecution},
      {"ankle_settings", AnkleSettings},
      {"contact_settings", ContactSettings},
      {"drive_settings", DriveSettings},
      {"emg_shape_settings", EmgShapeSettings},
      {"free_body_settings", FreeBodySettings},
      {"nms_settings", NmsSettings},
      {"hdf5_file", Hdf5File},
      {"mat_file", MatFile},
      {"dataset_file", DatasetFile},
      {"run_file", RunFile},
      {"study_file", StudyFile},
      {"pipeline", Pipeline},
      {"words", Words},
      {"step_states", StepStates},
  };
  return kTargets;
}

}  // namespace sinew::fuzz
