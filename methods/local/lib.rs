//! Cell-centred finite-volume enthalpy baseline: nearest neighbours on the lattice.
