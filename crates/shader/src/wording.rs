//! naga's words for people: no indices into its tables, types as WGSL writes them.

/// A message without handles, with types as WGSL writes them.
pub(crate) fn readable(message: &str) -> String {
    with_types(&without_handles(message))
}

/// naga's messages count things in its own tables, `[12]` or `Some([12])`; that helps no author.
pub(crate) fn without_handles(message: &str) -> String {
    let message = without_options(message);
    let message = message.as_str();
    let mut clean = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(open) = rest.find('[') {
        let digits = rest[open + 1..]
            .bytes()
            .take_while(u8::is_ascii_digit)
            .count();
        let close = open + 1 + digits;
        if digits > 0 && rest[close..].starts_with(']') {
            let before = rest[..open].trim_end();
            clean.push_str(before);
            // After these a noun is missing.
            let is_open = ["of", "in", "for", "to", "and", "with"]
                .contains(&before.rsplit(' ').next().unwrap_or(""));
            clean.push_str(if is_open { " …" } else { "" });
            rest = &rest[close + 1..];
        } else {
            clean.push_str(&rest[..=open]);
            rest = &rest[open + 1..];
        }
    }
    clean + rest
}

/// `Some([12])` as `[12]`.
fn without_options(message: &str) -> String {
    let mut clean = String::with_capacity(message.len());
    let mut rest = message;
    while let Some((before, after)) = rest.split_once("Some([") {
        clean.push_str(before);
        rest = match after.split_once("])") {
            Some((handle, after)) if handle.bytes().all(|c| c.is_ascii_digit()) => {
                clean.push_str(&format!("[{handle}]"));
                after
            }
            _ => {
                clean.push_str("Some([");
                after
            }
        };
    }
    clean + rest
}

/// Types that stand as Rust writes naga's, as WGSL writes them.
fn with_types(message: &str) -> String {
    let mut message = message.to_owned();
    for (kind, letter) in [("Float", 'f'), ("Sint", 'i'), ("Uint", 'u')] {
        for width in [2, 4, 8] {
            let scalar = format!("Scalar {{ kind: {kind}, width: {width} }}");
            message = message.replace(&scalar, &format!("{letter}{}", 8 * width));
        }
    }
    message = message.replace("Scalar { kind: Bool, width: 1 }", "bool");
    let sizes = [("Bi", 2), ("Tri", 3), ("Quad", 4)];
    for scalar in ["f16", "f32", "f64", "i32", "i64", "u32", "u64", "bool"] {
        message = message.replace(&format!("Scalar({scalar})"), scalar);
        for (rows, n) in sizes {
            let vector = format!("Vector {{ size: {rows}, scalar: {scalar} }}");
            message = message.replace(&vector, &format!("vec{n}<{scalar}>"));
            for (columns, m) in sizes {
                let matrix =
                    format!("Matrix {{ columns: {columns}, rows: {rows}, scalar: {scalar} }}");
                message = message.replace(&matrix, &format!("mat{m}x{n}<{scalar}>"));
            }
        }
    }
    message.replace("… (of type ", "(")
}

/// A label of naga's for people: its automatic ones are Rust type names.
pub(crate) fn label(label: &str) -> String {
    let Some(kind) = label.strip_prefix("naga::") else {
        return if label.is_empty() {
            "here".to_owned()
        } else {
            without_handles(label)
        };
    };
    let kind = kind.split(' ').next().unwrap_or("");
    match kind.rsplit("::").next().unwrap_or("") {
        "Expression" => "in this expression",
        "Function" => "in this function",
        "Type" => "this type",
        "GlobalVariable" => "this variable",
        "Constant" => "this constant",
        "Override" => "this override",
        "LocalVariable" => "this local variable",
        _ => "here",
    }
    .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn handles_are_taken_out_and_indices_are_not() {
        assert_eq!(
            without_handles("Function [12] 'f' is invalid"),
            "Function 'f' is invalid"
        );
        assert_eq!(
            without_handles("expression Some([3]) is not Some([1]), Some([x"),
            "expression is not, Some([x"
        );
        assert_eq!(
            without_handles("The type of [3] is not"),
            "The type of … is not"
        );
        assert_eq!(without_handles("a[i] or [x, [3]"), "a[i] or [x,");
        assert_eq!(label("naga::ir::Expression [3]"), "in this expression");
    }

    #[test]
    fn types_are_wgsls() {
        let naga = "Operation Multiply can't work with [3] (of type Vector { size: Tri, scalar: Scalar { kind: Float, \
                    width: 4 } }) and [4] (of type Scalar(Scalar { kind: Uint, width: 4 }))";
        assert_eq!(
            readable(naga),
            "Operation Multiply can't work with (vec3<f32>) and (u32)"
        );
    }
}
