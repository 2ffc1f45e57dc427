// reference_check.cpp - the reference a second way: Boost's Dormand-Prince 5(4) in long double, straight
// through the switches in plain time, its tolerance near the last bit: no series, no regularised variables,
// no roots.
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include "tests/bench/bench.h"

namespace
{

constexpr long double tolerance = 1e-18L;

template <int N> struct system_check {
    using state = std::array<long double, N>;
    const equation &e;

    void operator()(const state &y, state &dy, long double t) const
    {
        if constexpr (N == 2)
            hertz(y, dy, t);
        else
            shaft(y, dy, t);
    }
    void hertz(const state &y, state &dy, long double t) const
    {
        long double force = y[0] > 0 ? y[0] * std::sqrt(y[0]) : 0.0L;
        long double fast = std::cos(e.w2 * t);
        dy[0] = y[1];
        dy[1] = e.f0 + (long double)e.held + e.f1 * std::cos(e.w1 * t + e.phase1) + e.f2 * fast - e.c * y[1] -
                e.k * y[0] - e.b * (1 + e.r * fast) * force;
    }
    void shaft(const state &y, state &dy, long double t) const
    {
        const long double bending[3] = {1, -2, 1};
        long double bend = y[0] - 2 * y[1] + y[2];
        for (int i = 0; i < 3; i++) {
            long double beyond = i == 1 ? 0 : std::fmax(y[i] - 1, 0.0L) + std::fmin(y[i] + 1, 0.0L);
            long double drive = i == 1 ? e.held + e.f1 * std::cos(e.w1 * t) : 0;
            dy[i] = y[3 + i];
            dy[3 + i] = (drive - e.damper[i] * y[3 + i] - e.support[i] * y[i] - bending[i] * bend -
                         e.spring * beyond) /
                        (long double)e.mass[i];
        }
    }
};

template <int N> double check(const problem &b)
{
    using namespace boost::numeric::odeint;
    using state = std::array<long double, N>;
    equation e = b.eq;
    state y;
    double worst = 0.0;
    auto stepper =
        make_controlled(tolerance, tolerance, runge_kutta_dopri5<state, long double, state, long double>());
    std::copy(b.y0, b.y0 + N, y.begin());
    for (int k = 0; k < b.n_out; k++) {
        for (int j = 0; j < b.holds; j++) {
            long double t0 = (long double)b.interval * (k + (long double)j / b.holds);
            long double t1 = (long double)b.interval * (k + (long double)(j + 1) / b.holds);
            if (b.held)
                e.held = b.held[k * b.holds + j];
            integrate_adaptive(stepper, system_check<N>{e}, y, t0, t1, (t1 - t0) * 0.01L);
        }
        for (int i = 0; i < N; i++)
            worst = std::fmax(worst, (double)std::fabs(y[i] - b.ref[k][i]) / b.column[i]);
    }
    return worst;
}

} // namespace

double reference_check(const problem *b)
{
    return b->eq.n == 2 ? check<2>(*b) : check<6>(*b);
}
