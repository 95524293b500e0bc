use super::*;

/// The soil of Srivastava and Yeh 1991 in metres and seconds: 1 cm/h, 0.1 /cm.
const SOIL: GardnerSoil = GardnerSoil { alpha: 10.0, residual: 0.06, saturated: 0.40, conductivity: 1e-2 / 3600.0 };

/// A column with fluxes over the saturated conductivity.
fn column(height: f64, bottom: f64, fluxes: [f64; 2]) -> GardnerColumn {
    GardnerColumn::new(SOIL, height, bottom, fluxes.map(|flux| flux * SOIL.conductivity)).expect("a column")
}

/// Columns from shallow to a hundred lengths of capillary rise, wetted and drained.
fn columns() -> Vec<GardnerColumn> {
    let mut found = Vec::new();
    for height in [0.01, 0.1, 1.0, 3.0, 3.9, 10.0] {
        for (bottom, fluxes) in [(0.0, [0.1, 0.9]), (-0.3, [0.9, 0.1]), (0.0, [0.0, 1.0])] {
            found.push(column(height, bottom, fluxes));
        }
    }
    found
}

/// Time (s) of a time without units.
fn seconds(time: f64) -> f64 {
    time * (SOIL.saturated - SOIL.residual) / (SOIL.alpha * SOIL.conductivity)
}

#[test]
fn roots_are_roots() {
    for height in [0.01, 1.0, 10.0, 100.0] {
        for number in 1..=TERMS {
            let wave = wave(number, height);
            let (sine, cosine) = (wave * height).sin_cos();
            assert!(
                (sine + 2.0 * wave * cosine).abs() < 1e-12 * (1.0 + 2.0 * wave) * number as f64,
                "{number} {height}"
            );
            assert!(wave * height > (number as f64 - 0.5) * PI && wave * height < number as f64 * PI);
        }
    }
}

#[test]
fn image_and_series_meet() {
    for column in columns().iter().filter(|column| column.height < NOTHING) {
        let square = column.height * column.height;
        let meeting = 2.0 * square / (NOTHING + (NOTHING * NOTHING - square).sqrt());
        for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let z = share * column.height / SOIL.alpha;
            let [before, after] = [1.0 - 1e-14, 1.0 + 1e-14].map(|factor| seconds(meeting * factor));
            assert!(column.is_early(meeting * (1.0 - 1e-12)) && !column.is_early(meeting * (1.0 + 1e-12)));
            let differences = [
                column.saturation(z, before) - column.saturation(z, after),
                (column.flux(z, before) - column.flux(z, after)) / SOIL.conductivity,
            ];
            for difference in differences {
                let difference = difference.abs() / (column.after - column.before).abs();
                assert!(difference < ERROR, "{} at {share}: {difference}", column.height);
            }
        }
    }
}

#[test]
fn start_and_ends_are_as_they_must_be() {
    for column in columns() {
        let height = column.height / SOIL.alpha;
        for time in [0.0, 1e-6, 1e-3, 0.1, 1.0, 5.0, 50.0, 1e4] {
            let t = seconds(time);
            assert!((column.saturation(0.0, t) - column.bottom).abs() < ERROR, "{height} {time}");
            if time > 0.0 {
                let surface = column.flux(height, t) / SOIL.conductivity;
                assert!((surface - column.after).abs() < ERROR, "{height} {time}: {surface}");
            }
        }
        // Steady states obey K_Z + K = q, before and after.
        for share in [0.0, 0.3, 1.0] {
            let z = share * height;
            let steady = |flux: f64| flux + (column.bottom - flux) * (-SOIL.alpha * z).exp();
            assert!((column.saturation(z, 0.0) - steady(column.before)).abs() < 1e-15);
            assert!((column.saturation(z, seconds(1e5)) - steady(column.after)).abs() < 1e-13);
            assert!((column.flux(z, seconds(1e5)) / SOIL.conductivity - column.after).abs() < 1e-13);
            let early = column.saturation(z, seconds(1e-12 * column.height.powi(2)));
            let limit = if share < 1.0 { 1e-14 } else { 2e-6 * column.height };
            assert!((early - steady(column.before)).abs() < limit, "{height} {share}: {early}");
        }
    }
}

/// Differences of fourth order stand for the derivatives in Richards' equation, which is taken in its own form: water content
/// against the gradient of `K (h_z + 1)`, with `K` from the head.
#[test]
fn heads_obey_the_equation_of_richards() {
    let derivative = |step: f64, value: &dyn Fn(f64) -> f64| {
        (8.0 * (value(step) - value(-step)) - (value(2.0 * step) - value(-2.0 * step))) / (12.0 * step)
    };
    for column in columns().iter().filter(|column| column.height >= 0.5) {
        let height = column.height / SOIL.alpha;
        for time in [0.05, 0.3, 2.0, 12.0] {
            for share in [0.2, 0.5, 0.8, 0.95] {
                let (z, t) = (share * height, seconds(time * column.height.min(4.0).powi(2) / 4.0));
                let (dz, dt) = (2e-3 / SOIL.alpha * column.height.min(1.0), 1e-3 * t);
                let flux = |z: f64| {
                    let conductivity = SOIL.conductivity * (SOIL.alpha * column.head(z, t)).exp();
                    conductivity * (derivative(dz, &|step| column.head(z + step, t)) + 1.0)
                };
                let scale = SOIL.conductivity * (column.after - column.before).abs();
                let own = column.flux(z, t);
                assert!((flux(z) - own).abs() < 1e-8 * scale, "{height} {time} {share}: {} {own}", flux(z));
                let storage = derivative(dt, &|step| column.water_content(z, t + step));
                let inflow = derivative(dz, &|step| column.flux(z + step, t));
                let rate = scale / height.min(1.0 / SOIL.alpha);
                assert!((storage - inflow).abs() < 1e-6 * rate, "{height} {time} {share}: {storage} {inflow}");
            }
        }
    }
}

#[test]
fn water_that_enters_is_stored_or_leaves() {
    for column in columns() {
        let height = column.height / SOIL.alpha;
        let end = seconds(0.7 * column.height);
        let simpson = |steps: u32, width: f64, value: &dyn Fn(f64) -> f64| {
            let weight = |step: u32| if step == 0 || step == steps { 1.0 } else { 2.0 + 2.0 * f64::from(step % 2) };
            (0..=steps).map(|step| weight(step) * value(f64::from(step) * width)).sum::<f64>() * width / 3.0
        };
        let stored = |t: f64| simpson(4000, height / 4000.0, &|z| column.water_content(z, t));
        let left = simpson(4000, end / 4000.0, &|t| column.bottom_flux(t));
        let entered = column.flux(height, end) * end;
        let error = stored(end) - stored(0.0) - (entered - left);
        assert!(error.abs() < 1e-7 * entered.abs().max(left), "{height}: {error} of {entered}");
    }
}

#[test]
fn numbers_out_of_range_are_named() {
    let error = GardnerColumn::new(SOIL, 1.0, 0.1, [0.0, 1e-6]).expect_err("no such column");
    assert_eq!(error.to_string(), "the head at the bottom is 0.1, it must be at most 0 m");
    for fluxes in [[0.0, 2.0 * SOIL.conductivity], [-SOIL.conductivity, 0.0]] {
        assert!(GardnerColumn::new(SOIL, 1.0, 0.0, fluxes).is_err());
    }
}
