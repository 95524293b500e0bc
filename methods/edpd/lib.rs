//! Energy-conserving dissipative particle dynamics: collisional and random heat exchange.
