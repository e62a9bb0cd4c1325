//! The page of `switchid report` in Debian's Chromium: nothing is loaded from elsewhere, what is in view is drawn and
//! can be zoomed, the rest is drawn when it comes into view.
//!
//! `SWITCHID_PAGE_ROWS=1000000 cargo test --release --test main page:: -- --nocapture` prints the page's bytes and the
//! time until it is zoomed for a recording of a million samples. Where there is no Chromium the test says so; on CI it
//! fails.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Zooms the first plot as soon as it is there, counts plots, scrolls to the end, and sends what it found.
const PROBE: &str = r#"<script>
addEventListener("load", async () => {
  const found = {};
  const frame = () => new Promise(requestAnimationFrame);
  const drawn = () => [...document.querySelectorAll(".js-plotly-plot")];
  while (!drawn().length) await frame();
  const axis = drawn()[0]._fullLayout.xaxis;
  const [from, to] = axis.range.map(Number);
  const zoomed = [from + 0.4 * (to - from), from + 0.5 * (to - from)];
  await Plotly.relayout(drawn()[0], { "xaxis.range": zoomed });
  await frame();
  found.milliseconds = performance.now();
  found.zoomed = drawn()[0]._fullLayout.xaxis.range.every((end, at) => Math.abs(end - zoomed[at]) < 1e-9);
  found.panels = document.querySelectorAll(".plot").length;
  found.first = drawn().length;
  scrollTo(0, document.body.scrollHeight);
  while (drawn().length == found.first) await frame();
  dispatchEvent(new Event("beforeprint"));
  found.all = drawn().length;
  found.loaded = performance.getEntriesByType("resource").map(entry => entry.name);
  await fetch("/found", { method: "POST", body: JSON.stringify(found) });
});
</script></body>"#;

/// Longest that the browser may take before it counts as hung.
const PATIENCE: Duration = Duration::from_secs(120);

fn rows() -> usize {
    std::env::var("SWITCHID_PAGE_ROWS").map_or(6000, |rows| rows.parse().unwrap())
}

fn switchid(folder: &Path, arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_switchid")).args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The report of a Duffing record.
fn page(folder: &Path) -> String {
    let duration = rows() as f64 * 1e-3;
    let plant = format!(
        "terms = [\"qdd\", \"qd\", \"q\", \"q^3\"]\nduration = {duration}\nseed = 5\nnoise = {{ q = 1e-3, qd = 2e-3 }}\n\
         excitation = {{ kind = \"multisine\", from = 1.0, to = 12.0, count = 20, rms = 2.0 }}\n\
         [[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.3, 4.0, 2.0]\n"
    );
    std::fs::write(folder.join("plant.toml"), plant).unwrap();
    // the name of a file that would end the element in which it stands
    let model = "name = \"</script>\"\n[terms]\ninertia = \"fit\"\nqd = \"fit\"\nq = \"fit\"\n\"q^3\" = \"fit\"\n";
    std::fs::write(folder.join("model.toml"), model).unwrap();
    switchid(folder, &["simulate", "plant.toml", "-o", "data.csv", "--force"]);
    switchid(folder, &["report", "data.csv", "--model", "model.toml", "-o", "page.html", "--force"]);
    std::fs::read_to_string(folder.join("page.html")).unwrap()
}

/// A browser that shows the address, or none where there is none.
fn browser(folder: &Path, address: &str) -> Option<Child> {
    let profile = format!("--user-data-dir={}", folder.join("profile").display());
    let mut command = Command::new("chromium");
    command.args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1200,900", &profile, address]);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()
}

/// Serves the page until the browser has sent what it found.
fn served(listener: &TcpListener, page: &str) -> serde_json::Value {
    listener.set_nonblocking(true).unwrap();
    let begun = Instant::now();
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false).unwrap();
                if let Some(found) = answer(stream, page) {
                    return found;
                }
            }
            Err(_) => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(begun.elapsed() < PATIENCE, "the page was never zoomed");
    }
}

/// Answers one request; what it brought, where it brought something.
fn answer(mut stream: TcpStream, page: &str) -> Option<serde_json::Value> {
    let mut reader = BufReader::new(stream.try_clone().unwrap());
    let (mut request, mut length) = (String::new(), 0);
    reader.read_line(&mut request).ok()?;
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).ok()?;
        if let Some(count) = line.to_lowercase().strip_prefix("content-length:") {
            length = count.trim().parse().unwrap();
        }
        if line.trim().is_empty() {
            break;
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).ok()?;
    let content = if request.starts_with("GET / ") { page } else { "" };
    let head = format!("HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: {}\r\n", content.len());
    stream.write_all(format!("{head}Connection: close\r\n\r\n{content}").as_bytes()).ok()?;
    request.starts_with("POST").then(|| serde_json::from_slice(&body).unwrap())
}

#[test]
fn a_report_can_be_zoomed_in_a_browser() {
    // the browser's own processes outlive it by a moment and still write: what is left then is no error
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let page = page(folder.path());
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
    assert!(
        page.contains("plotly.js v3.0.1"),
        "harness/tests/test_report.py names the version of the cross-check's page"
    );
    let probed = page.replacen("</body>", PROBE, 1);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/", listener.local_addr().unwrap());
    let Some(mut browser) = browser(folder.path(), &address) else {
        assert!(std::env::var_os("CI").is_none(), "chromium is missing: apt-get install chromium");
        return eprintln!("there is no chromium: the page was not looked at");
    };
    let found = served(&listener, &probed);
    browser.kill().unwrap();
    browser.wait().unwrap();
    let count = |key: &str| found[key].as_u64().unwrap();
    println!(
        "{} rows: {} bytes, zoomed after {} ms, {} panels",
        rows(),
        page.len(),
        found["milliseconds"],
        count("panels")
    );
    assert_eq!(found["zoomed"], true, "{found}");
    assert!(0 < count("first") && count("first") < count("panels") && count("all") == count("panels"), "{found}");
    let elsewhere = |name: &&serde_json::Value| !name.as_str().unwrap().starts_with(&address);
    assert_eq!(found["loaded"].as_array().unwrap().iter().filter(elsewhere).count(), 0, "{found}");
}
