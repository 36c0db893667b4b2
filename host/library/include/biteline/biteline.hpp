// SPDX-License-Identifier: MIT
#pragma once
/// \file The whole library but the sensor's client (biteline/sensor.hpp), which needs libzmq.

#include "biteline/calibrate.hpp"
#include "biteline/cloud.hpp"
#include "biteline/error.hpp"
#include "biteline/line.hpp"
#include "biteline/motion.hpp"
#include "biteline/plan.hpp"
#include "biteline/recording.hpp"
#include "biteline/stripe.hpp"
#include "biteline/transfer.hpp"
#include "biteline/version.hpp"
