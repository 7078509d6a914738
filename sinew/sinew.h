// Everything that a user's own model needs: derive from Problem, then Identify it.
#pragma once

#include "base/error.h"
#include "base/linear_algebra.h"
#include "base/random.h"
#include "base/spline.h"
#include "base/version.h"
#include "datasets/dataset.h"
#include "datasets/io/dataset_file.h"
#include "identify/files/run_file.h"
#include "identify/fit_setup.h"
#include "identify/identification/identification.h"
#include "identify/observation/sensor_effects.h"
#include "identify/problem.h"
#include "problems/registry.h"
