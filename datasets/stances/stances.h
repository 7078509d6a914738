// Stances: the times at which a plate (or a foot's channels) carries load.
#pragma once

#include <string>
#include <vector>

#include "datasets/dataset.h"

namespace sinew {

/// Why a contact is no stance to be fitted.
enum class ContactFault {
  kNone,
  kBegan,    ///< the record begins while the plate is loaded
  kEnds,     ///< the record ends while the plate is loaded
  kLight,    ///< its largest force is less than a fifth of the usual one: a touch
  kShort,    ///< shorter than 0.1 s or than a third of the usual duration
  kLong,     ///< longer than 1.6 times the usual duration: standing, or two steps without a gap
  kTwoFeet,  ///< the centre of pressure jumps by more than a foot is long: a second foot is on the plate
  kGap       ///< the force was not measured all the time
};

/// "began", "ends", "light", ...: the `left_out` in JSON; "" of kNone.
[[nodiscard]] const char* ToString(ContactFault fault);

/// One time that a plate is loaded.
struct Contact {
  std::string plate;   ///< NAME of NAME_force_y
  double from = 0;     ///< [s]
  double to = 0;       ///< [s]
  double peak_N = 0;   ///< largest vertical force
  double cop_x_m = 0;  ///< median centre of pressure; NaN if there is none
  double cop_z_m = 0;
  double cop_jump_m = 0;  ///< largest jump of the centre of pressure within 0.15 s, less the usual motion
  double double_support_s = 0;  ///< time of it at which another plate is loaded
  ContactFault fault = ContactFault::kNone;
};

/// What was found on one plate of a trial.
struct PlateContacts {
  std::string plate;
  double level_N = 0;  ///< of the unloaded plate
  double noise_N = 0;  ///< its robust standard deviation
  double on_N = 0;     ///< a contact must exceed it ...
  double off_N = 0;    ///< ... and lasts while the force does not fall below this
  int places = 1;  ///< groups of contacts whose centres of pressure are more than 0.6 m apart: several plates
  bool seen = true;  ///< false: the plate is never unloaded or never loaded, and says nothing
};

struct TrialContacts {
  std::vector<Contact> contacts;  ///< of all plates, in the order of their beginning
  std::vector<PlateContacts> plates;
};

/// The plates of a trial: names NAME with channels NAME_force_y, in order.
[[nodiscard]] std::vector<std::string> PlateNames(const Trial& trial);

/// Finds all contacts. Level and noise are the median and the robust deviation of the lower mode of the
/// vertical force; thresholds with hysteresis lie six and three deviations above, at least 3 % and 1.5 % of
/// the largest force (20 N and 10 N of 700 N are the usual choice, Zeni et al. 2008). Interruptions shorter
/// than 40 ms do not end a contact.
[[nodiscard]] TrialContacts FindContacts(const Trial& trial);

}  // namespace sinew
