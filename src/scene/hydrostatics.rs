//! Pressure of stacked layers at rest: the model's own compressible solution, and the incompressible one.
//!
//! Layer by layer from the top, `p + B = (p_top + B) e^(ρ0 g depth/B)` follows from dp/dz = −ρ g and Eq. 7; with B → ∞
//! it becomes ρ0 g depth.

/// One layer of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Height (m) of its top.
    pub top: f64,
    /// Height (m) of its bottom.
    pub bottom: f64,
    /// Reference density ρ0 (kg/m³).
    pub reference_density: f64,
    /// Whether its top is a free surface: the highest layer's is, and that of a layer with air above it.
    pub free_top: bool,
}

/// A column of layers, from the top down, each beginning where the one above ends.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Column {
    /// The layers.
    pub layers: Vec<Layer>,
    /// Strength of gravity g (m/s²).
    pub gravity: f64,
    /// Pressure (Pa) at the top of the column.
    pub surface_pressure: f64,
}

impl Column {
    /// Adds a cell of `height` (m) below the others, as part of the lowest layer if it is of the same density. A gap
    /// above it that a body fills (`in_body`) counts as fluid, for the fluid beside the body carries on the pressure; with
    /// air above it the cell begins anew.
    pub(super) fn push(&mut self, top: f64, height: f64, reference_density: f64, in_body: impl FnOnce(f64) -> bool) {
        let bottom = top - height;
        let mut free_top = true;
        if let Some(above) = self.layers.last_mut() {
            let is_beside = above.bottom - top < 0.5 * height;
            free_top = !is_beside && !in_body(above.bottom);
            if !free_top {
                above.bottom = top;
                if above.reference_density == reference_density {
                    above.bottom = bottom;
                    return;
                }
            }
        }
        self.layers.push(Layer { top, bottom, reference_density, free_top });
    }

    /// Pressure (Pa) at `height` (m) of a liquid with bulk modulus B (Pa) and background pressure χ (Pa).
    #[must_use]
    pub fn compressible(&self, height: f64, bulk_modulus: f64, chi: f64) -> f64 {
        self.descend(height, |p, rho0, depth| {
            (p - chi + bulk_modulus) * (rho0 * self.gravity * depth / bulk_modulus).exp() - bulk_modulus + chi
        })
    }

    /// Pressure (Pa) at `height` (m) of an incompressible liquid.
    #[must_use]
    pub fn incompressible(&self, height: f64) -> f64 {
        self.descend(height, |p, rho0, depth| p + rho0 * self.gravity * depth)
    }

    /// Follows the pressure down to `height`: `below(p, ρ0, depth)` is the pressure `depth` below a place with p. Above
    /// the top and below the bottom the outermost layers go on.
    fn descend(&self, height: f64, below: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let mut p = self.surface_pressure;
        for (k, layer) in self.layers.iter().enumerate() {
            if layer.free_top {
                p = self.surface_pressure;
            }
            if height >= layer.bottom || k + 1 == self.layers.len() {
                return below(p, layer.reference_density, layer.top - height);
            }
            p = below(p, layer.reference_density, layer.top - layer.bottom);
        }
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_layers() -> Column {
        let mut column = Column { gravity: 9.81, ..Column::default() };
        for k in 0..10 {
            column.push(0.4 - 0.04 * f64::from(k), 0.04, if k < 5 { 1000.0 } else { 2000.0 }, |_| false);
        }
        column
    }

    #[test]
    fn cells_merge_into_layers() {
        let column = two_layers();
        assert_eq!(column.layers.len(), 2);
        assert!((column.layers[0].bottom - 0.2).abs() < 1e-12 && column.layers[1].bottom.abs() < 1e-12);
    }

    #[test]
    fn incompressible_pressure_is_the_weight_above() {
        let column = two_layers();
        assert!((column.incompressible(0.3) - 981.0).abs() < 1e-9);
        assert!((column.incompressible(0.1) - (1962.0 + 1962.0)).abs() < 1e-9);
    }

    #[test]
    fn compressible_pressure_satisfies_the_balance_of_forces() {
        // dp/dz = −ρ g with ρ = ρ0 (1 + p/B), by central differences, in both layers.
        let (column, b) = (two_layers(), 6e5);
        for (height, rho0) in [(0.33, 1000.0), (0.07, 2000.0)] {
            let dz = 1e-5;
            let slope =
                (column.compressible(height + dz, b, 0.0) - column.compressible(height - dz, b, 0.0)) / (2.0 * dz);
            let weight = rho0 * (1.0 + column.compressible(height, b, 0.0) / b) * 9.81;
            assert!((slope + weight).abs() < 1e-4 * weight);
        }
        assert!(column.compressible(0.4, b, 0.0).abs() < 1e-9);
    }

    #[test]
    fn a_body_carries_the_weight_of_what_lies_above_and_air_does_not() {
        for (in_body, pressure) in [(true, 5000.0), (false, 0.0)] {
            let mut column = Column { gravity: 10.0, ..Column::default() };
            column.push(1.0, 0.1, 1000.0, |_| in_body);
            column.push(0.5, 0.1, 2000.0, |_| in_body);
            assert!((column.incompressible(0.5) - pressure).abs() < 1e-9);
            assert!((column.incompressible(0.95) - 500.0).abs() < 1e-9);
        }
    }
}
