// Reads the functions of an OpenSim file. Internal to models/.
#pragma once

#include "models/multibody/osim_xml.h"
#include "models/multibody/piecewise_polynomial.h"

namespace sinew {

/// The function element that is the property of `owner`: wrapped,
/// `<function><Constant>...</Constant></function>`, as up to OpenSim 3, or bare, `<Constant
/// name="function">`, as since OpenSim 4. A null node if there is none.
pugi::xml_node FindFunction(const pugi::xml_node& owner, const char* property);

/// Constant, LinearFunction, SimmSpline (NaturalCubicSpline), PiecewiseLinearFunction, PolynomialFunction, or
/// a MultiplierFunction of these. Errors: another function, or numbers that do not fit it.
Result<PiecewisePolynomial> ReadFunction(const OsimXml& xml, const pugi::xml_node& function);

}  // namespace sinew
