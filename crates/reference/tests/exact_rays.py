"""The numbers of exact_rays.tsv: sixteen rays in 40 digits.

Needs mpmath. Each ray is split where the scalar or the transfer function has a kink; between kinks the optical depth is an
antiderivative in closed form where the extinction is a polynomial of the distance, else a quadrature of its own.
Samples and control points are the float64 values that the test has.

    python3 exact_rays.py > exact_rays.tsv
"""

from mpmath import mp, mpf, exp, log, sqrt, quad

mp.dps = 45

SINES = [512, 688, 837, 936, 972, 936, 837, 688, 512, 336, 187, 88, 52, 88, 187, 336] * 2 + [512]

# name: (length, [(start, end, (a, b, c))]) with the scalar a + b t + c t² of the distance t from the ray's entry.
SCALARS = {
    "constant": (mpf(8), [(mpf(0), mpf(8), (mpf(614) / 1024, mpf(0), mpf(0)))]),
    "linear": (mpf(8), [(mpf(0), mpf(8), (mpf(0), mpf(1) / 8, mpf(0)))]),
    "quadratic": (8 * sqrt(mpf(2)), [(mpf(0), 8 * sqrt(mpf(2)), (mpf(0), mpf(0), mpf(1) / 128))]),
    "sinusoidal": (
        mpf(32),
        [
            (mpf(i), mpf(i + 1), (mpf(SINES[i]) / 1024 - i * mpf(SINES[i + 1] - SINES[i]) / 1024,
                                  mpf(SINES[i + 1] - SINES[i]) / 1024, mpf(0)))
            for i in range(32)
        ],
    ),
}

# name: (kind, [(at, value)], [(at, (r, g, b))])
COLORS = [(mpf(0), (mpf(1), mpf(0.25), mpf(0))), (mpf(1), (mpf(0), mpf(0.5), mpf(1)))]
TRANSFERS = {
    "smooth": ("opacity", [(mpf(0), mpf(0)), (mpf(1), mpf(0.75))], COLORS),
    "linear": ("extinction", [(mpf(0), mpf(0.03125)), (mpf(1), mpf(0.5))], COLORS),
    "step": ("extinction", [(mpf(0), mpf(0)), (mpf(0.5), mpf(0)), (mpf(0.5), mpf(0.75)), (mpf(1), mpf(0.75))], COLORS),
    "peak": ("extinction", [(mpf(0), mpf(0)), (mpf(0.59375), mpf(0)), (mpf(0.6015625), mpf(12)),
                            (mpf(0.609375), mpf(0)), (mpf(1), mpf(0))], COLORS),
}


def roots(terms, value):
    a, b, c = terms
    if c != 0:
        d = b * b - 4 * c * (a - value)
        return [] if d < 0 else [(-b - sqrt(d)) / (2 * c), (-b + sqrt(d)) / (2 * c)]
    return [(value - a) / b] if b != 0 else []


def piece_of(points, s):
    """The linear piece that s is inside of: (from, to, value at from, value at to)."""
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x0 < s < x1 or (x0 <= s < x1):
            return x0, x1, y0, y1
    return points[-1][0], points[-1][0] + 1, points[-1][1], points[-1][1]


def integrate(scalar, transfer):
    kind, absorption, colors = transfer
    _, parts = scalar
    knots = sorted({at for at, _ in absorption} | {at for at, _ in colors})
    color, transmittance = [mpf(0)] * 3, mpf(1)
    for start, end, terms in parts:
        cuts = sorted({start, end} | {r for k in knots for r in roots(terms, k) if start < r < end})
        for t0, t1 in zip(cuts, cuts[1:]):
            s = lambda t: terms[0] + t * (terms[1] + t * terms[2])
            x0, x1, y0, y1 = piece_of(absorption, s((t0 + t1) / 2))
            u = lambda t: y0 + (y1 - y0) * (s(t) - x0) / (x1 - x0)
            if kind == "extinction":
                kappa = u
                # The antiderivative of the polynomial u.
                k = (y1 - y0) / (x1 - x0)
                p = [y0 + k * (terms[0] - x0), k * terms[1], k * terms[2]]
                anti = lambda t: p[0] * t + p[1] * t**2 / 2 + p[2] * t**3 / 3
                depth = lambda t: anti(t) - anti(t0)
            else:
                kappa = lambda t: -log(1 - u(t))
                a, b, c = terms
                k = (y1 - y0) / (x1 - x0)
                v0, v1, v2 = 1 - (y0 + k * (a - x0)), -k * b, -k * c
                if v1 == 0 and v2 == 0:
                    depth = lambda t: -log(v0) * (t - t0)
                elif v2 == 0:
                    # of -log(v) dt with v = v0 + v1 t
                    anti = lambda t: -((v0 + v1 * t) * log(v0 + v1 * t) - (v0 + v1 * t)) / v1
                    depth = lambda t: anti(t) - anti(t0)
                else:
                    # v = v0 + v2 t² with v2 < 0 < v0: of -log(v) dt
                    r = sqrt(-v0 / v2)
                    anti = lambda t: -(t * log(v0 + v2 * t * t) - 2 * t + r * log((r + t) / (r - t)))
                    assert v1 == 0
                    depth = lambda t: anti(t) - anti(t0)
            (c0, rgb0), (c1, rgb1) = colors
            for i in range(3):
                tint = lambda t: rgb0[i] + (rgb1[i] - rgb0[i]) * (s(t) - c0) / (c1 - c0)
                if kappa(t0) != 0 or kappa(t1) != 0:
                    color[i] += transmittance * quad(lambda t: tint(t) * kappa(t) * exp(-depth(t)), [t0, (t0 + t1) / 2, t1])
            transmittance *= exp(-depth(t1))
    return color, transmittance


print("# scalar\ttransfer\tred\tgreen\tblue\ttransmittance")
for scalar in ("constant", "linear", "quadratic", "sinusoidal"):
    for transfer in ("smooth", "linear", "step", "peak"):
        color, transmittance = integrate(SCALARS[scalar], TRANSFERS[transfer])
        print(scalar, transfer, *(mp.nstr(v, 40) for v in (*color, transmittance)), sep="\t")
