#include "datasets/io/force_file.h"

#include <pugixml.hpp>
#include <sstream>

namespace sinew {
namespace {

void AddText(pugi::xml_node parent, const char* element, const std::string& text) {
  parent.append_child(element).text().set(text.c_str());
}

}  // namespace

Storage ForceTable(const GroundLoads& loads) {
  Storage table;
  table.title = "ground reaction forces";
  table.in_degrees = false;
  table.time = loads.time;
  for (const PlateLoad& load : loads.plates) {
    const ExternalForce force = ForceOn(load.plate, "");
    std::size_t column = 0;
    for (const std::string& identifier :
         {force.force_identifier, force.point_identifier, force.torque_identifier}) {
      for (const char* axis : {"x", "y", "z"}) {
        table.names.push_back(identifier + axis);
        table.columns.push_back(load.values[column++]);
      }
    }
  }
  return table;
}

ExternalForce ForceOn(const std::string& plate, const std::string& body) {
  return {plate, body, plate + "_ground_force_v", plate + "_ground_force_p", plate + "_ground_torque_"};
}

std::string ExternalLoadsText(const std::vector<ExternalForce>& forces, const std::string& table) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child("OpenSimDocument");
  root.append_attribute("Version") = "30000";
  pugi::xml_node loads = root.append_child("ExternalLoads");
  loads.append_attribute("name") = "ground_reaction";
  pugi::xml_node objects = loads.append_child("objects");
  for (const ExternalForce& force : forces) {
    pugi::xml_node node = objects.append_child("ExternalForce");
    node.append_attribute("name") = force.name.c_str();
    AddText(node, "isDisabled", "false");
    AddText(node, "applied_to_body", force.applied_to_body);
    AddText(node, "force_expressed_in_body", "ground");
    AddText(node, "point_expressed_in_body", "ground");
    AddText(node, "force_identifier", force.force_identifier);
    AddText(node, "point_identifier", force.point_identifier);
    AddText(node, "torque_identifier", force.torque_identifier);
  }
  AddText(loads, "datafile", table);
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace sinew
