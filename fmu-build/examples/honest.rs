//! A library in which `check` finds nothing.

mod stand_in;

fmi_adapter::export!(stand_in::StandIn<false>);
