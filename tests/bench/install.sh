#!/bin/sh
# install.sh - what the speed-against-accuracy benchmark and its charts need, on Debian 12.
#   install.sh           installs what is missing; as root
#   install.sh --check   only says what is missing; 0 when nothing is
missing=
need() { # file-or-command package
    [ -e "$1" ] || command -v "$1" >/dev/null || missing="$missing $2"
}
need g++ g++
need /usr/include/cvode/cvode.h libsundials-dev
need /usr/include/gsl/gsl_odeiv2.h libgsl-dev
need /usr/include/boost/numeric/odeint.hpp libboost-dev
need gnuplot gnuplot-nox
[ -z "$missing" ] && exit 0
echo "the benchmark's peers are not all here; missing:$missing"
if [ "$1" = --check ]; then
    echo "as root: tests/bench/install.sh"
    exit 1
fi
[ "$(id -u)" = 0 ] || { echo "run as root, or: apt-get install$missing"; exit 1; }
apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
