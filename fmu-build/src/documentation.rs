//! documentation/index.html: the same table for people.

use fmi_adapter::{Variant, variables};
use lander_models::signals::Interface;

use crate::xml::escape;

pub fn page(interface: &Interface, variant: Variant) -> String {
    let mut rows = String::new();
    for v in variables(interface, variant) {
        let cells = [
            v.reference.to_string(),
            v.name.clone(),
            type_name(v.slot.data_type(variant), v.size),
            v.slot.causality().to_owned(),
            v.unit.unwrap_or("").to_owned(),
            v.start.clone().unwrap_or_default(),
            range_text(v.range),
            v.description.to_owned(),
        ];
        let cells: String = cells.iter().map(|cell| format!("<td>{}</td>", escape(cell))).collect();
        rows += &format!("<tr>{cells}</tr>\n");
    }
    let (model, description) = (escape(interface.model), escape(interface.description));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">\
         <title>{model}</title></head>\n<body>\n<h1>{model}</h1>\n<p>{description}.</p>\n\
         <p>The communication step is any whole number of milliseconds. Inputs are held over a \
         step. Outputs at a communication point do not depend on inputs at that point.</p>\n\
         <table>\n<tr><th>reference</th><th>name</th><th>type</th><th>causality</th>\
         <th>unit</th><th>start</th><th>range</th><th>description</th></tr>\n{rows}</table>\n</body>\n</html>\n"
    )
}

/// `Float64`, `Float64[3]`
fn type_name(scalar: &str, size: usize) -> String {
    if size == 1 { scalar.to_owned() } else { format!("{scalar}[{size}]") }
}

/// `0 … 1`, `0 …`, nothing
fn range_text((least, greatest): (f64, f64)) -> String {
    let end = |end: f64| if end.is_finite() { end.to_string() } else { String::new() };
    match (least.is_finite(), greatest.is_finite()) {
        (false, false) => String::new(),
        _ => format!("{} … {}", end(least), end(greatest)),
    }
}
