//! The page as a file: the bundled program with the data in it.

use crate::error::ReportError;
use crate::report::Report;

/// The page without data, as `cargo xtask report-page` bundled it; empty when it did not.
const PAGE: &str = include_str!(concat!(env!("OUT_DIR"), "/page.html"));

/// Where the page wants its title and its data.
const TITLE: &str = "%STICKSLIP_TITLE%";
const DATA: &str = "%STICKSLIP_DATA%";

/// The page without data; `None` in a program that was built without it.
pub fn page() -> Option<&'static str> {
    (!PAGE.is_empty()).then_some(PAGE)
}

/// `page` with the title and the data of `report`.
///
/// # Errors
/// Without a result.
pub(crate) fn fill(page: &str, report: &Report) -> Result<String, ReportError> {
    let (title, data) = (report.title()?, report.json()?);
    // One after the other from the left: what was put in is not looked at again.
    let (head, rest) = page.split_once(TITLE).ok_or(ReportError::NoPage)?;
    let (body, foot) = rest.split_once(DATA).ok_or(ReportError::NoPage)?;
    Ok([head, &html_text(title), body, &in_script(&data), foot].concat())
}

/// A text between tags.
fn html_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// JSON that may stand in a script element: nothing in it ends the element or begins a comment, and it is JSON still.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::recorded::Recorded;

    const HOSTILE: &str = "</script><img src=x onerror=alert(1)><!-- %STICKSLIP_DATA% \u{2028} & \"";

    fn report() -> Report {
        let result = serde_json::json!({
            "format_version": 1, "scene": HOSTILE, "dofs": [HOSTILE], "notes": [HOSTILE],
            "points": [{
                "frequency": 1.0, "status": "failed", "harmonics": 1, "iterations": 3, "residual": null,
                "reason": HOSTILE,
            }],
        });
        let mut report = Report::default();
        report.add(HOSTILE, Recorded::from_json(&result.to_string()).unwrap()).unwrap();
        report
    }

    #[test]
    fn a_hostile_name_stays_a_text() {
        let page = format!("<title>{TITLE}</title><script type=\"application/json\">{DATA}</script>");
        let html = fill(&page, &report()).unwrap();
        // The only tags are those of the page.
        assert_eq!(html.matches('<').count(), 4);
        assert!(!html.contains('\u{2028}') || html.split("<script").next().unwrap().contains('\u{2028}'));
        let data = html.split("json\">").nth(1).unwrap().strip_suffix("</script>").unwrap();
        let value: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!(value["results"][0]["scene"], HOSTILE);
        assert_eq!(value["results"][0]["points"]["reason"][0], HOSTILE);
        assert!(html.starts_with("<title>&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;"));
    }
}
