//! A library whose model keeps something outside its state.

mod stand_in;

fmi_adapter::export!(stand_in::StandIn<true>);
