#include "cli/data/contact_settings.h"

#include "base/read_file.h"
#include "problems/kit/bind.h"

namespace sinew {

Result<ContactSettings> ContactSettingsOf(const std::string& path, const Dataset& data,
                                          const std::string& config) {
  constexpr const char* kName = "contact";
  if (config.empty()) {
    if (data.files.count(kContactSettingsFile) == 0)
      return Fail("{}: holds no contact.yaml: give settings with --config (sinew data soles)", path);
    SINEW_ASSIGN(const YamlReader section, SettingsSection(data, kName));
    return ReadContactSettings(section, data.files);
  }
  SINEW_ASSIGN(const std::string text, ReadFile(config));
  SINEW_ASSIGN(const YamlReader document, YamlReader::Parse(text, config));
  SINEW_ASSIGN(const YamlReader section, SettingsSection(document, kName));
  return ReadContactSettings(section, data.files);
}

}  // namespace sinew
