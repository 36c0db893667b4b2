// SPDX-License-Identifier: MIT
// Those parts of Asio and Beast that are no templates, compiled once.
#include "host/apps/biteline-web/beast.hpp"

#include <boost/asio/impl/src.hpp>
#include <boost/asio/ssl/impl/src.hpp>
#include <boost/beast/src.hpp>
