/* Checks of a fleet in compiled code: the benchmark compares the numpy engine with them, to show the gain left. */
#include <math.h>

static double power(double r) { return r * r * r * cbrt(r); }

/* cycles: axes x phases x (T, n, t); asked: axes x (pause, T_k, life); gears: gears x (i, T_N, T_R, T_M, n_av, n_max, kg) */
void size(int axes, int phases, const double *cycles, const double *asked, int gears, const double *gear,
          double rated_speed, double rated_life, int *selected, int *suitable)
{
    for (int a = 0; a < axes; a++) {
        const double *cycle = cycles + 3 * phases * a, *wish = asked + 3 * a;
        double most = 0, fastest = 0, time = 0, weight = 0, damage = 0;
        for (int p = 0; p < phases; p++) {
            most = fmax(most, cycle[3 * p]);
            fastest = fmax(fastest, cycle[3 * p + 1]);
        }
        for (int p = 0; p < phases; p++) {
            double turns = cycle[3 * p + 1] * cycle[3 * p + 2];
            time += cycle[3 * p + 2];
            weight += turns;
            damage += turns * power(cycle[3 * p] / most);
        }
        double mean = most * pow(damage / weight, 0.3), speed = weight / (time + wish[0]), best = INFINITY, used_best = 0, life_best = 0;
        selected[a] = -1;
        suitable[a] = 0;
        for (int g = 0; g < gears; g++) {
            const double *is = gear + 7 * g;
            double life = rated_life * (rated_speed / (is[0] * speed) * power(is[1] / mean));
            double uses[6] = {mean / is[1], most / is[2], wish[1] / is[3], is[0] * speed / is[4], is[0] * fastest / is[5], wish[2] / life};
            double used = 0;
            int known = 1;
            for (int c = 0; c < 6; c++) {
                known &= !isnan(uses[c]);
                used = fmax(used, uses[c]);
            }
            if (!known || used > 1 + 1e-12)
                continue;
            suitable[a]++;
            if (is[6] < best ||
                (is[6] == best && (used < used_best || (used == used_best && life > life_best)))) {
                best = is[6];
                used_best = used;
                life_best = life;
                selected[a] = g;
            }
        }
    }
}
