//! Which numbers stand beside a bar of colours, and where.

/// A tick beside the bar, with or without a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Where it is along the bar, 0 at its lower end and 1 at its upper one.
    pub share: f64,
    /// The number, and the exponent that is raised behind it; both empty for a small tick.
    pub number: String,
    /// See `number`.
    pub exponent: String,
}

impl Mark {
    fn plain(share: f64, number: String) -> Self {
        Self {
            share,
            number,
            exponent: String::new(),
        }
    }
}

/// Most numbers beside a bar.
const MOST: f64 = 9.0;

/// The marks of a scale from `low` to `high`, either of which may be the larger one: decades on a logarithmic scale,
/// where both are above 0; multiples of 1, 2 or 5 times a power of ten on a linear one.
pub fn marks(low: f64, high: f64, is_logarithmic: bool) -> Vec<Mark> {
    let place = |number: f64| {
        if is_logarithmic {
            number.log10()
        } else {
            number
        }
    };
    let (from, to) = (place(low), place(high));
    let share = |at: f64| (at - from) / (to - from);
    let (least, most) = (from.min(to), from.max(to));
    // Rounding may not lose a mark at an end.
    let slack = 1e-9 * (most - least);
    // A span of nothing, and one that no number tells apart from it, has its number alone.
    if !(slack > 1e-12 * least.abs() && slack.is_finite()) {
        return vec![Mark::plain(0.5, text(low, 0.0))];
    }
    let multiples = |step: f64| {
        let first = ((least - slack) / step).ceil();
        let last = ((most + slack) / step).floor();
        #[expect(
            clippy::cast_possible_truncation,
            reason = "few marks fit between the ends"
        )]
        let count = (last - first + 1.0).clamp(0.0, 1000.0) as i32;
        (0..count).map(move |index| (first + f64::from(index)) * step)
    };
    if !is_logarithmic {
        let step = nice_step((most - least) / (MOST - 3.0));
        return multiples(step)
            .map(|at| Mark::plain(share(at), text(at, step)))
            .collect();
    }
    let step = ((most - least) / (MOST - 1.0)).ceil().max(1.0);
    let mut marks: Vec<Mark> = multiples(step)
        .map(|decade| Mark {
            share: share(decade),
            number: "10".to_owned(),
            exponent: format!("{decade:.0}"),
        })
        .collect();
    if marks.len() < 2 {
        // Less than two decades are told by their ends.
        marks = [low, high]
            .map(|end| Mark::plain(share(place(end)), text(end, 0.0)))
            .into();
    }
    let small = |decade: f64| (2..10).map(move |digit| decade + f64::from(digit).log10());
    if step == 1.0 {
        let within = |at: &f64| *at > least && *at < most;
        let at = multiples(1.0).chain([(least - slack).floor()]);
        let ticks = at.flat_map(small).filter(within);
        marks.extend(ticks.map(|at| Mark::plain(share(at), String::new())));
    }
    marks
}

/// The smallest of 1, 2 and 5 times a power of ten that is not below a length.
fn nice_step(length: f64) -> f64 {
    let decade = 10f64.powf(length.log10().floor());
    let digits = [1.0, 2.0, 5.0].into_iter();
    digits
        .map(|digit| digit * decade)
        .find(|step| *step >= length * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// A number with the places that a step needs; with three digits where the step is 0.
fn text(number: f64, step: f64) -> String {
    let size = number.abs().max(step);
    let least = if step > 0.0 { step } else { size };
    if size != 0.0 && (size >= 1e5 || least < 1e-3) {
        let text = format!("{number:.2e}");
        // 2.00e-7 is 2e-7.
        return text.replace(".00e", "e").replace("0e", "e");
    }
    let digits = if step > 0.0 { 0.0 } else { 2.0 };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most six places"
    )]
    let places = (digits - least.max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    let rounded = format!("{number:.places$}");
    // Nothing below 0 is left of -0.
    if rounded.trim_start_matches('-').parse() == Ok(0.0) {
        return "0".to_owned();
    }
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(low: f64, high: f64, is_logarithmic: bool) -> Vec<String> {
        let of = |mark: Mark| (!mark.number.is_empty()).then(|| mark.number + &mark.exponent);
        marks(low, high, is_logarithmic)
            .into_iter()
            .filter_map(of)
            .collect()
    }

    #[test]
    fn decades_stand_at_their_shares() {
        let marks = marks(1e-4, 1.0, true);
        let decades: Vec<_> = marks.iter().filter(|it| !it.number.is_empty()).collect();
        let exponents: Vec<_> = decades.iter().map(|it| it.exponent.as_str()).collect();
        assert_eq!(exponents, ["-4", "-3", "-2", "-1", "0"]);
        for (index, mark) in decades.iter().enumerate() {
            assert!((mark.share - index as f64 / 4.0).abs() < 1e-12, "{mark:?}");
        }
        // Eight small ticks in each of four decades; 2e-4 stands at log10(2) / 4.
        assert_eq!(marks.len(), 5 + 32);
        let second = 2f64.log10() / 4.0;
        assert!(marks.iter().any(|it| (it.share - second).abs() < 1e-12));
    }

    #[test]
    fn long_and_short_scales_have_few_numbers() {
        assert_eq!(
            numbers(1e-30, 1.0, true),
            [
                "10-28", "10-24", "10-20", "10-16", "10-12", "10-8", "10-4", "100"
            ]
        );
        assert_eq!(numbers(0.2, 0.7, true), ["0.200", "0.700"]);
        assert_eq!(numbers(3e-7, 8e-7, true), ["3e-7", "8e-7"]);
    }

    #[test]
    fn linear_numbers_are_round() {
        assert_eq!(numbers(0.0, 340.0, false), ["0", "100", "200", "300"]);
        assert_eq!(
            numbers(-0.1, 0.1, false),
            ["-0.10", "-0.05", "0", "0.05", "0.10"]
        );
        // Upside down, and of no span.
        assert_eq!(numbers(1.0, 0.0, false).len(), 6);
        assert_eq!(numbers(2.5, 2.5, false), ["2.50"]);
        assert_eq!(numbers(0.0, 2e-6, false).last().unwrap(), "2e-6");
        for (low, high) in [(f64::MIN, f64::MAX), (0.0, 1e-300), (1e9, 1e9 + 1e-9)] {
            assert!(marks(low, high, false).len() < 20, "{low} {high}");
        }
    }
}
