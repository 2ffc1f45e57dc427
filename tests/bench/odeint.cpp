// odeint.cpp - Boost odeint: dopri5 with dense output, with and without located contacts; controlled rkf78;
// fixed steps.
#include <algorithm>
#include <array>
#include <boost/numeric/odeint.hpp>
#include <boost/version.hpp>
#include <cmath>
#include <cstdio>
#include "tests/bench/bench.h"

namespace
{

using namespace boost::numeric::odeint;

struct settings {
    const problem *b;
    double absolute, relative;
    int steps;
};

template <int N> struct system_of {
    const equation *e;
    void operator()(const std::array<double, N> &y, std::array<double, N> &dy, double t) const
    {
        if constexpr (N == 2)
            equation_hertz(e, t, y.data(), dy.data());
        else
            equation_shaft(e, t, y.data(), dy.data());
    }
};

// What every way of running shares: samples of the force, outputs.
template <int N, class Advance>
void outputs(const problem &b, double (*out)[EQUATION_STATES], Advance advance)
{
    equation e = b.eq;
    std::array<double, N> y;
    std::copy(b.y0, b.y0 + N, y.begin());
    e.closed = equation_regime(&e, y.data());
    for (int k = 0; k < b.n_out; k++) {
        for (int j = 0; j < b.holds; j++) {
            if (b.held)
                e.held = b.held[k * b.holds + j];
            advance(e, y, b.interval * (k + double(j) / b.holds), b.interval * (k + double(j + 1) / b.holds));
        }
        std::copy(y.begin(), y.end(), out[k]);
    }
}

template <int N> using dopri5 = runge_kutta_dopri5<std::array<double, N>>;

// Dense output: steps run over the outputs; a sampled force starts anew with the step size that it had.
template <int N> void run_dense(void *context, double (*out)[EQUATION_STATES])
{
    auto *s = static_cast<settings *>(context);
    auto stepper = make_dense_output(s->absolute, s->relative, dopri5<N>());
    double step = 1e-2;
    bool first = true;
    outputs<N>(*s->b, out, [&](equation &e, auto &y, double t0, double t1) {
        if (first || s->b->held)
            stepper.initialize(y, t0, s->b->held ? std::min(step, t1 - t0) : step);
        first = false;
        while (stepper.current_time() < t1) {
            stepper.do_step(system_of<N>{&e});
            step = stepper.current_time_step();
        }
        stepper.calc_state(t1, y);
    });
}

// Root of overlap i between lo and hi on the interpolant.
template <int N, class Stepper>
double locate(Stepper &stepper, const equation &e, int i, double lo, double hi, std::array<double, N> &y)
{
    double rate, at = hi;
    bool closed = (e.closed >> i) & 1u;
    for (int k = 0; k < 30; k++) {
        stepper.calc_state(at, y);
        double overlap = equation_overlap(&e, y.data(), i, &rate);
        ((overlap > 0.0) != closed ? hi : lo) = at;
        double next = at - overlap / rate;
        if (!(next >= lo && next <= hi))
            next = 0.5 * (lo + hi);
        if (std::fabs(next - at) < 1e-15 * (1.0 + at))
            break;
        at = next;
    }
    return at;
}

// Regime locked; a step that ends in another one is cut at the switch, where the integration starts anew.
template <int N> void run_events(void *context, double (*out)[EQUATION_STATES])
{
    auto *s = static_cast<settings *>(context);
    auto stepper = make_dense_output(s->absolute, s->relative, dopri5<N>());
    double step = 1e-2, from = 0.0;
    bool first = true;
    outputs<N>(*s->b, out, [&](equation &e, auto &y, double t0, double t1) {
        std::array<double, N> z;
        double rate;
        if (first || s->b->held) {
            e.locked = true;
            stepper.initialize(y, t0, s->b->held ? std::min(step, t1 - t0) : step);
            from = t0;
        }
        first = false;
        for (;;) {
            // From the state known to be in its regime to the end of the step, or of the interval.
            double to = std::min(stepper.current_time(), t1), at = to;
            int which = -1;
            for (int i = 0; i < e.n_contacts && to > from; i++) {
                stepper.calc_state(to, z);
                if ((equation_overlap(&e, z.data(), i, &rate) > 0.0) == bool((e.closed >> i) & 1u))
                    continue;
                double root = locate<N>(stepper, e, i, from, to, z);
                if (which < 0 || root < at) {
                    at = root;
                    which = i;
                }
            }
            if (which >= 0) {
                stepper.calc_state(at, z);
                e.closed ^= 1u << which;
                stepper.initialize(z, at, step);
                from = at;
            } else {
                from = to;
            }
            if (from >= t1)
                break;
            if (stepper.current_time() <= from) {
                stepper.do_step(system_of<N>{&e});
                step = stepper.current_time_step();
            }
        }
        if (from > stepper.current_time() || from == stepper.current_time())
            y = stepper.current_state();
        else
            stepper.calc_state(t1, y);
    });
}

template <int N> void run_rkf78(void *context, double (*out)[EQUATION_STATES])
{
    auto *s = static_cast<settings *>(context);
    auto stepper = make_controlled(s->absolute, s->relative, runge_kutta_fehlberg78<std::array<double, N>>());
    double step = 1e-2;
    outputs<N>(*s->b, out, [&](equation &e, auto &y, double t, double t1) {
        while (t < t1) {
            double last = step;
            bool cut = t + step > t1;
            if (cut)
                step = t1 - t;
            if (stepper.try_step(system_of<N>{&e}, y, t, step) == success && cut)
                t = t1, step = std::max(step, last);
        }
    });
}

template <int N, class Stepper> void run_fixed(void *context, double (*out)[EQUATION_STATES])
{
    auto *s = static_cast<settings *>(context);
    Stepper stepper;
    outputs<N>(*s->b, out, [&](equation &e, auto &y, double t0, double t1) {
        double h = (t1 - t0) / s->steps;
        for (int i = 0; i < s->steps; i++)
            stepper.do_step(system_of<N>{&e}, y, t0 + i * h, h);
    });
}

using runner = void (*)(void *, double (*)[EQUATION_STATES]);

void add(bench *b, const char *family, const char *setting, double knob, runner run, const settings &s)
{
    entry *e = bench_add(b, family, setting, knob);
    e->run = run;
    e->context = new settings(s);
    e->release = [](void *c) { delete static_cast<settings *>(c); };
}

template <int N> void add_all(bench *b)
{
    using state = std::array<double, N>;
    const problem *p = &b->problem;
    for (int i = 0; i < BENCH_TOLERANCES; i++) {
        double tol = bench_tolerance(i);
        for (double relative : {tol, 0.0}) {
            settings s = {p, tol, relative, 0};
            bool both = relative > 0.0;
            add(b, "odeint dopri5", both ? "dense" : "dense, absolute only", tol, run_dense<N>, s);
            add(b, "odeint dopri5", both ? "dense, events" : "dense, events, absolute only", tol,
                run_events<N>, s);
            add(b, "odeint rkf78", both ? "controlled" : "controlled, absolute only", tol, run_rkf78<N>, s);
        }
    }
    for (double n = p->held ? 1.0 : 4.0; n * p->n_out * p->holds <= 3e5; n *= std::sqrt(2.0)) {
        settings s = {p, 0.0, 0.0, int(n)};
        add(b, "odeint rk4", "fixed step", s.steps, run_fixed<N, runge_kutta4<state>>, s);
        add(b, "odeint dopri5", "fixed step", s.steps, run_fixed<N, dopri5<N>>, s);
        add(b, "odeint rkf78", "fixed step", s.steps, run_fixed<N, runge_kutta_fehlberg78<state>>, s);
    }
}

} // namespace

void odeint_add(bench *b)
{
    b->problem.eq.n == 2 ? add_all<2>(b) : add_all<6>(b);
}

const char *odeint_version_text()
{
    return "Boost odeint " BOOST_LIB_VERSION;
}
