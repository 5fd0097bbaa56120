//! `lander-truth.*.fmu`: the C symbols around the truth model, and nothing else.

fmi_adapter::export!(truth_model::TruthModel);
