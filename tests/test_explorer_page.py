"""What is said to a model on the explorer's page, in a real browser before a real server."""

import time

import pytest

from explorer_reader import Window


def test_every_edit_by_mouse(window):
    page = window.page
    concepts = window.state()["concepts"]
    first, second, third = [concept["key"] for concept in concepts[:3]]
    n_first = concepts[0]["size"]
    window.choose_concept(first)
    page.locator("#do-name").click()
    page.locator("#dialog input").fill("round things")
    page.locator("#dialog .primary").click()
    assert window.made(1)["concepts"][0]["name"] == "round things"

    window.choose_concept(second)
    window.tile(0).click()
    window.tile(2).click(modifiers=["Shift"])
    assert page.locator(".chosen").inner_text() == "3 chosen"
    page.locator("#do-move").click()
    page.locator("#dialog li", has_text="round things").click()
    assert window.made(2)["concepts"][0]["size"] == n_first + 3

    window.tile(1).click()
    page.locator("#do-move").click()
    page.locator("#dialog input").fill("odd ones")
    page.locator("#dialog li", has_text="a new concept").click()
    assert "odd ones" in [concept["name"] for concept in window.made(3)["concepts"]]

    window.tile(0).click()
    page.locator("#do-foreign").click()
    assert len(window.made(4)["foreign"]) == 1

    window.choose_concept(third)
    window.tile(0).click()
    page.locator("#do-confirm").click()
    window.made(5)
    window.tile(0).click()
    window.tile(1).click(modifiers=["Control"])
    page.locator("#do-together").click()
    assert window.made(6)["links"][0][2] is True
    page.locator("#do-merge").click()
    page.locator("#dialog li", has_text="round things").click()
    n_concepts = len(window.made(7)["concepts"])

    window.choose_concept(first)
    window.tile(0).click()
    window.tile(1).click(modifiers=["Control"])
    page.locator("#do-split").click()
    page.locator("#dialog input[value=scans]").check()
    page.locator("#dialog .primary").click()
    assert len(window.made(8)["concepts"]) == n_concepts + 1

    page.locator("#said button").click()
    window.made(7)
    page.locator("#do-redo").click()
    window.made(8)
    page.locator("#do-undo").click()
    window.made(7)
    page.locator("#view-journal").click()
    page.locator(".edits button", has_text="Back to here").last.click()
    assert window.made(1)["concepts"][0]["name"] == "round things"
    assert window.edits() == ["rename"]
    assert window.complaints == []


def test_every_edit_by_keyboard_alone(window):
    page, press = window.page, window.press
    state = window.state()
    keys = [concept["key"] for concept in state["concepts"]]

    def to_concept(key: int) -> None:
        """From the gallery back to the list at the left."""
        for _ in range(60):
            if page.evaluate("document.activeElement?.getAttribute('href')") == f"#concept/{key}":
                break
            in_list = page.evaluate("document.activeElement.matches('#left a')")
            press("ArrowDown" if in_list else "Shift+Tab")
            if in_list and page.evaluate("document.activeElement.matches('#left .concepts li:last-child a')"):
                press(*["ArrowUp"] * 40)
        press("Enter")
        page.wait_for_function("key => location.hash === `#concept/${key}`", arg=key)

    to_concept(keys[0])
    press("n")
    page.keyboard.type("first")
    press("Enter")
    assert window.made(1)["concepts"][0]["name"] == "first"
    to_concept(keys[1])
    press("Home", "Shift+ArrowRight", "v")
    page.keyboard.type("fir")
    press("Enter")
    window.made(2)
    press("Home", "v")
    page.keyboard.type("second")
    press("Enter")
    window.made(3)
    press("Home", "x")
    window.made(4)
    press("Home", "c")
    window.made(5)
    press("Home", " ", "ArrowRight", "ArrowRight", " ", "t")
    window.made(6)
    press("Home", "Shift+ArrowRight", "a")
    window.made(7)
    to_concept(keys[2])
    press("m")
    page.keyboard.type("first")
    press("Enter")
    window.made(8)
    to_concept(keys[0])
    press("Home", "Shift+ArrowRight", "s", "Enter")
    window.made(9)
    press("Control+z")
    window.made(8)
    press("Control+Shift+Z")
    window.made(9)
    assert " ".join(window.edits()) == "rename move move foreign confirm link link merge split"
    press("/")
    page.keyboard.type("ball")
    assert page.locator(".place-title h2").inner_text().startswith("Found for")
    press("Enter", "Escape", "j")
    assert page.locator("#journal").is_visible()
    press("j", "f")
    page.wait_for_selector("#figures canvas.timeline")
    page.locator("#figures canvas.map").first.focus()
    press("ArrowRight", "Enter")
    page.wait_for_function("() => !document.getElementById('scans').hidden")
    press("?")
    assert page.locator("#dialog table").is_visible()
    press("Escape")
    assert window.complaints == []


def test_granularity_is_tried_before_it_is_used(window):
    page = window.page
    slider = page.locator("#slider input")
    n_concepts = len(window.state()["concepts"])
    slider.focus()
    window.press("Home")
    page.wait_for_function(
        "() => document.querySelector('.place-title h2').textContent.includes('granularity')"
    )
    assert window.edits() == [] and page.locator("#left .concepts li").count() == n_concepts
    window.press("Escape")
    page.wait_for_function(
        "() => !document.querySelector('.place-title h2').textContent.includes('granularity')"
    )
    slider.focus()
    window.press("Home")
    page.get_by_role("button", name="Use this").click()
    assert len(window.made(1)["concepts"]) < n_concepts
    # A branch of the tree leads to its scans.
    box = page.locator(".slider-tree").bounding_box()
    page.mouse.click(box["x"] + 3, box["y"] + box["height"] / 2)
    page.wait_for_function("() => location.hash.startsWith('#branch/')")
    assert page.locator(".tile:not([aria-hidden])").count() > 5
    assert window.complaints == []


def test_questions_are_answered_until_there_are_none(window):
    page, n_concepts = window.page, len(window.state()["concepts"])
    page.wait_for_function("() => document.getElementById('do-question').classList.contains('primary')")
    window.press("q")
    n = 0
    for n in range(1, 30):
        question = window.state()["question"]
        if question is None:
            break
        if question["kind"] == "name":
            page.locator("#answer").fill(f"kind {question['key']}")
            window.press("Enter")
        else:
            # The page goes on to the next question after it tells that the last one is answered.
            page.locator(".place-title h2", has_text="Which of these are something else?").wait_for()
            page.locator(".question .primary").click()
        window.made(n)
    assert window.state()["question"] is None
    assert n > n_concepts
    assert all(concept["name"] for concept in window.state()["concepts"])
    assert window.complaints == []


def test_what_is_something_else_is_moved_and_the_rest_confirmed(window):
    page, concepts = window.page, window.state()["concepts"]
    for concept in concepts:
        state = window.edit(kind="rename", key=concept["key"], name=f"kind {concept['key']}")
    if state["question"] is None:
        pytest.skip("nothing is doubtful")
    n = len(concepts)
    window.made(n)
    window.press("q")
    page.wait_for_selector(".question .primary")
    window.tile(0).click()
    assert "Say what the chosen one is" in page.locator(".question .primary").inner_text()
    window.press("Enter")
    page.keyboard.type("something new")
    window.press("Enter")
    assert "something new" in [concept["name"] for concept in window.made(n + 1)["concepts"]]
    if page.locator(".tile:not([aria-hidden])").count():
        window.press("Enter")
        window.made(n + 2)
        assert window.edits()[-2:] == ["move", "confirm"]
    assert window.complaints == []


def test_two_windows_see_each_others_edits_within_a_second(browser, window):
    other = Window(browser, window.address).open()
    key = window.state()["concepts"][0]["key"]
    for name, here, there in [("from here", window, other), ("from there", other, window)]:
        here.choose_concept(key)
        here.press("n")
        here.page.keyboard.type(name)
        here.press("Enter")
        start = time.monotonic()
        there.page.wait_for_function(
            "name => document.querySelector('#left .concepts').textContent.includes(name)",
            arg=name,
            polling=20,
        )
        assert time.monotonic() - start < 1
    # What is being typed stays while another window edits.
    here.press("n")
    here.page.keyboard.type("half a na")
    there.edit(kind="rename", key=key, name="meanwhile")
    here.page.wait_for_function(
        "() => document.querySelector('#left .concepts').textContent.includes('meanwhile')"
    )
    assert here.page.locator("#dialog input").input_value() == "half a na"
    other.close()
    assert window.complaints == [] and other.complaints == []


def test_the_corrected_data_set_and_its_report_are_written(window, explored_folder):
    page = window.page
    window.edit(kind="rename", key=window.state()["concepts"][0]["key"], name="named")
    window.press("e")
    page.locator("#dialog select").select_option("csv")
    page.locator("#dialog input").fill("table")
    page.locator("#dialog .primary").click()
    page.wait_for_function(
        "() => document.querySelector('#dialog [role=status]').textContent.startsWith('Written')"
    )
    assert "named" in next(explored_folder.glob("table*")).read_text()
    page.locator("#dialog .primary").click()
    page.wait_for_function("() => document.querySelector('#dialog .refusal').textContent !== ''")
    page.locator("#dialog select").select_option("report")
    page.locator("#dialog input").fill("page")
    page.locator("#dialog .primary").click()
    page.wait_for_function(
        "() => document.querySelector('#dialog [role=status]').textContent.startsWith('Written')"
    )
    assert "named" in next(explored_folder.glob("page*")).read_text()
